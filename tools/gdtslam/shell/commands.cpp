#include "commands.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>  // needed by the constructor, for CLI::App::help()

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "console.hpp"
#include "engine/core/memory/out_of_memory.hpp"
#include "engine/io/did_you_mean.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/help/command_tree.hpp"
#include "tools/gdtslam/shell/help/help_page.hpp"

namespace gdtslam {
namespace {

// Optional parts in this build.
std::string parts_of_build() {
  std::vector<std::string_view> parts;
  if (GDTSLAM_HAS_VULKAN) parts.emplace_back("Vulkan");
#ifdef GDTSLAM_HAS_VIEWER
  parts.emplace_back("viewer");
#endif
#ifdef GDTSLAM_HAS_SIM
  parts.emplace_back("simulator");
#endif
  return parts.empty() ? "no optional part" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string instruction_sets() {
  std::string text(to_string(best_isa()));
  text += " of ";
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    text.append(k == 0 ? "" : ", ").append(to_string(static_cast<Isa>(k)));
  }
  return text;
}

std::string version_text(const BuildStamp& build) {
  const std::string date = build.date.empty() ? std::string() : fmt::format(" of {}", build.date);
  return fmt::format(
      "gdtslam {}\n"
      "commit    {}{}\n"
      "built with {}\n"
      "computes  by the instruction set {}\n",
      GDTSLAM_VERSION, build.commit, date, parts_of_build(), instruction_sets());
}

constexpr const char* kHelpGroup = "This machine and this program";

// A sub-command that this build leaves out says which option it needs.
void add_missing_command(CLI::App& app, CommandContext& context, const CommandRow& row) {
  const std::string option = row.missing_option;
  CLI::App* command = add_command(app, row.name, "Not in this build (" + option + "=OFF)");
  command->group(kMissingCommands);
  command->allow_extras();
  const std::string reason = std::string("this build has no '") + row.name + "'; configure it with -D" + option + "=ON";
  command->callback([&context, reason] { context.run = [reason]() -> int { throw UnavailableError(reason); }; });
}

void add_row(CLI::App& app, CommandContext& context, const CommandRow& row) {
  if (row.add == nullptr) return add_missing_command(app, context, row);
  row.add(app, context);
  app.get_subcommand(row.name)->group(row.group);
}

std::vector<std::string> list_names(CLI::App* app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* command : app->get_subcommands([](CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

// Full name of a sub-command: "gdtslam map".
std::string command_path(const CLI::App* app) {
  return app->get_parent() == nullptr ? app->get_name() : command_path(app->get_parent()) + " " + app->get_name();
}

std::string help_text(CLI::App* app) { return help_page(command_text(*app), help_width()); }

int print_help_on(CLI::App* app, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const auto named = app->get_subcommands([&word](const CLI::App* command) { return command->get_name() == word; });
    if (named.empty()) {
      throw UsageError("there is no command '" + word + "'" + did_you_mean(word, list_names(app)) + " (see '" +
                       command_path(app) + " --help')");
    }
    app = named.front();
  }
  print_result(help_text(app));
  return static_cast<int>(ExitCode::kDone);
}

void add_help_command(CLI::App& app, CommandContext& context, const Program& program) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = add_command(app, "help", "Help on a command, as --help behind it");
  CLI::Option* const named =
      command->add_option("command", *words, "The command, and its own command after it (default: the list of all)");
  named->type_name("NAME");
  std::vector<std::string> names = list_names(&app);
  std::erase_if(names, [](const std::string& name) { return name.starts_with('-'); });
  offer_words(named, std::move(names));
  command->group(kHelpGroup);
  command->footer(std::string("Examples:\n  ") + program.name + " help " + program.commands.front().name);
  command->callback([&app, &context, words] { context.run = [&app, words] { return print_help_on(&app, *words); }; });
}

std::unique_ptr<CLI::App> make_app(const Program& program, CommandContext& context) {
  auto app = std::make_unique<CLI::App>(program.description, program.name);
  const auto version = [build = context.build] { return version_text(build); };
  app->set_version_flag("--version", version, "Print the version, its commit and what this build can do, and exit");
  app->set_help_flag("-h,--help", "Print this help and exit");
  app->require_subcommand(1);
  app->footer(program.examples);
  for (const CommandRow& command : program.commands) add_row(*app, context, command);
  add_help_command(*app, context, program);
  return app;
}

// The deepest sub-command that was named.
CLI::App* chosen_app(CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

/// Commands of older versions, and their replacements.
constexpr std::array<std::pair<std::string_view, const char*>, 3> kMovedCommands{{
    {"tiles", "is an option now: gdtslam edit RUN --tiles -o DIR"},
    {"devices", "is an option now: gdtslam doctor --devices"},
    {"measure", "is a part of evaluate now: gdtslam evaluate RUN --boxes, or --planes"},
}};

std::string usage_message(CLI::App* root, const CLI::ParseError& error) {
  CLI::App* const app = chosen_app(root);
  std::string message = error.what();
  const std::vector<std::string> unknown = root->remaining(true);
  if (!unknown.empty() && !unknown.front().empty()) {
    const std::string word = unknown.front().substr(0, unknown.front().find('='));
    for (const auto& [name, what] : kMovedCommands) {
      if (word == name && app == root) return fmt::format("'{}' {}", name, what);
    }
    const bool is_command = app->get_require_subcommand_min() > 0 && word.front() != '-';
    message = (is_command ? "there is no command '" : "unexpected argument '") + word + "'" +
              did_you_mean(word, list_names(app));
  }
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message + " (see '" + command_path(app) + " --help')";
}

int report(std::string_view message, ExitCode code) {
  print_error(message);
  return static_cast<int>(code);
}

int parse_and_run(int argc, char** argv, const Program& program, const BuildStamp& build) {
  CommandContext context;
  context.build = build;
  const std::unique_ptr<CLI::App> app = make_app(program, context);
  if (argc <= 1) return print_help_on(app.get(), {});
  try {
    app->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    print_result(help_text(chosen_app(app.get())));
    return static_cast<int>(ExitCode::kDone);
  } catch (const CLI::CallForVersion& version) {
    print_result(version.what());
    return static_cast<int>(ExitCode::kDone);
  } catch (const CLI::ParseError& error) {
    return report(usage_message(app.get(), error), ExitCode::kUsage);
  }
  const std::string command = command_path(chosen_app(app.get()));
  const std::string what_to_do = " in '" + command + "'; " + context.when_out_of_memory;
  try {
    return context.run();
  } catch (const OutOfMemory& error) {  // the command's memory is free again here
    return report(error.what() + what_to_do, error.code());
  } catch (const std::bad_alloc&) {
    return report("out of memory" + what_to_do, ExitCode::kFailed);
  }
}

std::terminate_handler usual_end = nullptr;

// Reports lack of memory inside a noexcept function of a library: one line, as elsewhere.
[[noreturn]] void end_in_one_line() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    constexpr std::string_view kLine = "gdtslam: error: out of memory\n";
    static_cast<void>(!::write(STDERR_FILENO, kLine.data(), kLine.size()));
    ::_exit(static_cast<int>(ExitCode::kFailed));
  } catch (...) {
    usual_end();
  }
  std::abort();
}

}  // namespace

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* const command = parent.add_subcommand(name, description);
  command->group("Commands");
  return command;
}

int run_command_line(int argc, char** argv, const Program& program, const BuildStamp& build) noexcept {
  usual_end = std::set_terminate(end_in_one_line);
  try {
    return parse_and_run(argc, argv, program, build);
  } catch (const Error& error) {
    const bool is_of_input = error.code() == ExitCode::kBadInput || error.code() == ExitCode::kBadConfig;
    if (!is_of_input || !interrupted()) return report(error.what(), error.code());
    return report("interrupted while it read its input", ExitCode::kInterrupted);  // its input was cut short
  } catch (const std::bad_alloc&) {
    std::fputs("gdtslam: error: out of memory before the command began\n", stderr);
  } catch (const std::exception& error) {
    return report(std::string("unexpected: ") + error.what(), ExitCode::kFailed);
  }
  return static_cast<int>(ExitCode::kFailed);
}

}  // namespace gdtslam
