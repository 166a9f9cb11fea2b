// gdtslam generate: completions of shells, and what their scripts ask for. Manual pages are made by help2man
// (tools/scripts/man_page.sh).
#include <CLI/App.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "completion.hpp"
#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"

namespace gdtslam {
namespace {

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
