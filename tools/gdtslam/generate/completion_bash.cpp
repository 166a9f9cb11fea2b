#include <fmt/format.h>

#include "completion.hpp"

namespace gdtslam {
namespace {

// Bash breaks the word under the cursor at '=' and ':' and replaces what is behind them only, so the line is taken
// apart here, and what bash keeps is cut off the answers. File names are left to _filedir where bash-completion is
// there, which knows quotes and '~'.
constexpr const char* kBashHead = R"bash(# bash completion for gdtslam, made by 'gdtslam generate completion bash'.

_gdtslam_reply() { # WHAT-IS-TYPED WORD...
  local typed=$1 breaks="" cut="" word
  shift
  [[ $COMP_WORDBREAKS == *=* ]] && breaks+="="
  [[ $COMP_WORDBREAKS == *:* ]] && breaks+=":"
  [[ -n $breaks && $typed == *[$breaks]* ]] && cut=${typed%"${typed##*[$breaks]}"}
  for word in "$@"; do
    [[ $word == "$typed"* ]] && COMPREPLY+=("${word#"$cut"}")
  done
}

_gdtslam_files() { # WHAT-IS-TYPED ENDING...
  local cur=$1 endings file
  shift
  endings=$(IFS='|'; echo "${*#.}")
  if declare -F _filedir >/dev/null; then
    if [[ -n $endings ]]; then _filedir "@($endings)"; else _filedir; fi
    return
  fi
  compopt -o filenames 2>/dev/null
  while IFS= read -r file; do
    if [[ -d $file || -z $endings || $file =~ \.(${endings//./\\.})$ ]]; then COMPREPLY+=("$file"); fi
  done < <(compgen -f -- "$cur")
}

_gdtslam_folders() { # WHAT-IS-TYPED
  local cur=$1 folder
  if declare -F _filedir >/dev/null; then
    _filedir -d
    return
  fi
  compopt -o filenames 2>/dev/null
  while IFS= read -r folder; do COMPREPLY+=("$folder"); done < <(compgen -d -- "$cur")
}

)bash";

constexpr const char* kBashMain = R"bash(_gdtslam() {
  local line=${COMP_LINE:0:COMP_POINT} path=gdtslam option="" typed word
  local -a words
  COMPREPLY=()
  read -ra words <<<"$line"
  [[ $line == *[[:blank:]] ]] && words+=("")
  for word in "${words[@]:1:${#words[@]}-2}"; do
    if _gdtslam_is_command "$path $word"; then path+=" $word"; fi
  done
  typed=${words[-1]}
  if [[ $typed == --*=* ]]; then
    option=${typed%%=*}
    typed=${typed#*=}
  elif ((${#words[@]} > 2)) && [[ ${words[-2]} == -* ]]; then
    option=${words[-2]}
  fi
  if [[ -n $option ]] && _gdtslam_value "$path" "$option" "$typed"; then return; fi
  if [[ $typed == -* ]]; then
    _gdtslam_options "$path" "$typed"
  else
    _gdtslam_argument "$path" "$typed"
  fi
}
complete -F _gdtslam gdtslam
)bash";

std::string bash_calls(const Offers& offers) {
  std::string calls;
  if (offers.has_settings) calls += " _gdtslam_setting \"$3\";";
  if (!offers.words.empty()) calls += fmt::format(" _gdtslam_reply \"$3\" {};", spaced(offers.words));
  if (offers.has_files) calls += fmt::format(" _gdtslam_files \"$3\" {};", spaced(offers.endings));
  if (offers.has_folders && !offers.has_files) calls += " _gdtslam_folders \"$3\";";
  return calls.empty() ? " :;" : calls;
}

// Whether the option takes a value, and if so what is offered for it.
std::string bash_values(const std::vector<const CommandText*>& commands) {
  std::string text = "_gdtslam_value() { # COMMAND OPTION WHAT-IS-TYPED\n  case \"$1 $2\" in\n";
  for (const CommandText* command : commands) {
    for (const OptionText* option : options_in(*command)) {
      if (option->value.empty()) continue;
      std::string pattern;
      for (const std::string& name : option->names) {
        pattern += fmt::format("{}\"{} {}\"", pattern.empty() ? "" : " | ", command->path, name);
      }
      text += fmt::format("    {}){} return 0 ;;\n", pattern, bash_calls(option->offers));
    }
  }
  return text + "  esac\n  return 1\n}\n\n";
}

std::string bash_options(const std::vector<const CommandText*>& commands) {
  std::string text = "_gdtslam_options() { # COMMAND WHAT-IS-TYPED\n  case \"$1\" in\n";
  for (const CommandText* command : commands) {
    std::string names;
    for (const OptionText* option : options_in(*command)) names += " " + spaced(option->names);
    text += fmt::format("    \"{}\") _gdtslam_reply \"$2\"{} ;;\n", command->path, names);
  }
  return text + "  esac\n}\n\n";
}

std::string bash_arguments(const std::vector<const CommandText*>& commands) {
  std::string text = "_gdtslam_argument() { # COMMAND WHAT-IS-TYPED\n  set -- \"$1\" \"\" \"$2\"\n  case \"$1\" in\n";
  for (const CommandText* command : commands) {
    Offers offers = offers_of_arguments(*command);
    for (const CommandText& below : command->commands) {
      if (below.group != kMissingCommands) offers.words.push_back(below.name);
    }
    if (!offers.is_empty()) text += fmt::format("    \"{}\"){} ;;\n", command->path, bash_calls(offers));
  }
  return text + "  esac\n}\n\n";
}

std::string bash_commands(const std::vector<const CommandText*>& commands) {
  std::string text = "_gdtslam_is_command() {\n  case \"$1\" in\n";
  for (const CommandText* command : commands) text += fmt::format("    \"{}\") return 0 ;;\n", command->path);
  return text + "  esac\n  return 1\n}\n\n";
}

std::string bash_settings(const SettingRows& settings) {
  std::string paths;
  std::string text = "_gdtslam_setting() { # WHAT-IS-TYPED\n  case \"$1\" in\n";
  for (const OptionRow& row : settings) {
    paths += " " + row.path + "=";
    if (row.choices.empty()) continue;
    text += fmt::format("    {}=*) _gdtslam_reply \"$1\"", row.path);
    for (const std::string& choice : row.choices) text += fmt::format(" {}={}", row.path, choice);
    text += " ;;\n";
  }
  text +=
      "    *=*) ;;\n    *)\n      compopt -o nospace 2>/dev/null\n      _gdtslam_reply \"$1\"" + paths + "\n      ;;\n";
  return text + "  esac\n}\n\n";
}

}  // namespace

std::string bash_completion(const CommandText& root, const SettingRows& settings) {
  const std::vector<const CommandText*> commands = commands_from(root);
  return kBashHead + bash_settings(settings) + bash_commands(commands) + bash_options(commands) +
         bash_arguments(commands) + bash_values(commands) + kBashMain;
}

}  // namespace gdtslam
