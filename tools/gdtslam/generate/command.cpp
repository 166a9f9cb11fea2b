// gdtslam generate: shell completions, and the answers that their scripts request. Manual pages are made by help2man
// (tools/scripts/man_page.sh).
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/command_tree.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/help/option_rows.hpp"

namespace gdtslam {
namespace {

// Bash splits the word at the cursor at '=' and ':' and replaces only the part after it, so the part before is cut off
// the answers. The scripts call the program on PATH, never one in the working folder.
constexpr std::string_view kBash = R"bash(# bash completion for gdtslam, made by 'gdtslam generate completion bash'.
_gdtslam() {
  local line=${COMP_LINE:0:COMP_POINT} breaks="" cut="" cur offer file endings
  local -a words
  COMPREPLY=()
  read -ra words <<<"$line"
  [[ $line == *[[:blank:]] ]] && words+=("")
  cur=${words[-1]}
  [[ $COMP_WORDBREAKS == *=* ]] && breaks+="="
  [[ $COMP_WORDBREAKS == *:* ]] && breaks+=":"
  [[ -n $breaks && $cur == *[$breaks]* ]] && cut=${cur%"${cur##*[$breaks]}"}
  while IFS= read -r offer; do
    case $offer in
      :files*)
        cur=${cur#"$cut"} endings=${offer#:files} endings=${endings// ./|}
        compopt -o filenames 2>/dev/null
        while IFS= read -r file; do
          if [[ -d $file || -z $endings || $file =~ \.(${endings#|})$ ]]; then COMPREPLY+=("$file"); fi
        done < <(compgen -f -- "$cur")
        ;;
      :folders)
        compopt -o filenames 2>/dev/null
        while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -d -- "${cur#"$cut"}")
        ;;
      *)
        [[ $offer == *= ]] && compopt -o nospace 2>/dev/null
        COMPREPLY+=("${offer#"$cut"}")
        ;;
    esac
  done < <(command gdtslam generate offers -- "${words[@]:1}" 2>/dev/null)
}
complete -F _gdtslam gdtslam
)bash";

constexpr std::string_view kZsh = R"zsh(#compdef gdtslam
# zsh completion for gdtslam, made by 'gdtslam generate completion zsh'.
_gdtslam() {
  local offer
  local -a endings
  for offer in "${(@f)$(command gdtslam generate offers -- "${(@)words[2,CURRENT]}" 2>/dev/null)}"; do
    case $offer in
      '') ;;
      :files) compset -P '--*='; _files ;;
      :files*) compset -P '--*='; endings=(${=offer#:files}); _files -g "*(${(j:|:)endings})" ;;
      :folders) compset -P '--*='; _files -/ ;;
      *=) compadd -S '' -- "$offer" ;;
      *) compadd -- "$offer" ;;
    esac
  done
}
if [ "$funcstack[1]" = _gdtslam ]; then
  _gdtslam "$@"
else
  compdef _gdtslam gdtslam
fi
)zsh";

/// Words that begin with the typed text.
class Answers {
 public:
  explicit Answers(std::string typed) : typed_(std::move(typed)) {}

  void add(const std::string& word) {
    if (word.starts_with(typed_)) lines_ += word + "\n";
  }
  /// Adds values after `before`, which is "--option=" or empty.
  void add(const Offers& offers, const std::string& before, const std::vector<OptionRow>& settings) {
    for (const std::string& word : offers.words) add(before + word);
    if (offers.has_settings) add_settings(before, settings);
    if (offers.has_files)
      lines_ += fmt::format(":files{}{}\n", offers.endings.empty() ? "" : " ", fmt::join(offers.endings, " "));
    if (offers.has_folders && !offers.has_files) lines_ += ":folders\n";
  }
  [[nodiscard]] const std::string& lines() const { return lines_; }

 private:
  void add_settings(const std::string& before, const std::vector<OptionRow>& settings) {
    for (const OptionRow& row : settings) {
      const std::string path = before + row.path + "=";
      if (!typed_.starts_with(path)) add(path);
      for (const std::string& choice : row.choices) {
        if (typed_.starts_with(path)) add(path + choice);
      }
    }
  }

  std::string typed_;
  std::string lines_;
};

const CommandText* command_below(const CommandText& command, const std::string& name) {
  const auto found = std::find_if(command.commands.begin(), command.commands.end(), [&name](const CommandText& below) {
    return below.name == name && below.group != kMissingCommands;
  });
  return found == command.commands.end() ? nullptr : &*found;
}

const OptionText* option_named(const CommandText& command, const std::string& name) {
  for (const OptionGroup& group : command.groups) {
    for (const OptionText& option : group.options) {
      if (std::find(option.names.begin(), option.names.end(), name) != option.names.end()) return &option;
    }
  }
  return nullptr;
}

/// The script of a shell; empty if the shell is neither bash nor zsh.
std::string_view completion_script(std::string_view shell) {
  return shell == "bash" ? kBash : shell == "zsh" ? kZsh : std::string_view();
}

/// Completions of the last word, which is being typed: whole words, one per line. `words` follow the program's name.
/// Lines ":files .ply .pcd" (":files" for any) and ":folders" stand for names that the shell finds itself.
std::string offers_behind(const CommandText& root, const std::vector<std::string>& words,
                          const std::vector<OptionRow>& settings) {
  if (words.empty()) return {};
  const CommandText* command = &root;
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    if (const CommandText* const below = command_below(*command, words[k])) command = below;
  }
  const std::string& typed = words.back();
  const std::size_t equals = typed.starts_with("--") ? typed.find('=') : std::string::npos;
  const std::string before = equals == std::string::npos ? "" : typed.substr(0, equals + 1);
  const std::string name = !before.empty() ? typed.substr(0, equals) : words.size() > 1 ? words[words.size() - 2] : "";
  Answers answers(typed);
  const OptionText* const option = name.starts_with('-') ? option_named(*command, name) : nullptr;
  if (option != nullptr && !option->value.empty()) {
    answers.add(option->offers, before, settings);
  } else if (typed.starts_with('-')) {
    for (const OptionGroup& group : command->groups) {
      for (const OptionText& one : group.options) {
        for (const std::string& word : one.names) answers.add(word);
      }
    }
  } else {
    for (const CommandText& below : command->commands) {
      if (below.group != kMissingCommands) answers.add(below.name);
    }
    for (const OptionText& argument : command->arguments) answers.add(argument.offers, "", settings);
  }
  return answers.lines();
}

int print_script(const std::string& shell) {
  const std::string_view script = completion_script(shell);
  if (script.empty()) {
    throw UsageError("there are no completions for '" + shell + "'" + did_you_mean(shell, {"bash", "zsh"}) +
                     ": bash or zsh");
  }
  print_result(script);
  return static_cast<int>(ExitCode::kDone);
}

int print_offers(CLI::App& root, const std::vector<std::string>& words) {
  Settings settings;
  print_result(offers_behind(command_text(root), words, option_rows(settings, "")));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_generate_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = add_command(app, "generate", "Completions for bash and zsh");
  command->require_subcommand(1);
  auto shell = std::make_shared<std::string>();
  CLI::App* completion = add_command(*command, "completion", "What a shell completes when TAB is pressed");
  offer_words(completion->add_option("shell", *shell, "The shell: bash or zsh")->type_name("SHELL")->required(),
              {"bash", "zsh"});
  completion->footer(
      "Examples:\n"
      "  source <(gdtslam generate completion bash)\n"
      "  gdtslam generate completion zsh > ~/.zsh/functions/_gdtslam");
  completion->callback([shell, &context] { context.run = [shell] { return print_script(*shell); }; });
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* offers = command->add_subcommand("offers", "What fits behind these words of a command line");
  offers->group("");
  offers->add_option("words", *words, "Words after the program's name, the last one as far as it is typed");
  offers->callback([&app, words, &context] { context.run = [&app, words] { return print_offers(app, *words); }; });
  command->footer("Examples:\n  gdtslam generate completion bash");
}

}  // namespace gdtslam
