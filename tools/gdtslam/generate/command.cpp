// gdtslam generate: manual pages and completions of shells, made of the command's own tree and table of options.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "completion.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "man_pages.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

struct ManOptions {
  std::string page = "gdtslam";
  std::string folder;
  bool list = false;
};

struct CompletionOptions {
  std::string shell;
  std::string file;
};

/// A shell, and who writes its completions.
struct Shell {
  std::string_view name;
  std::string (*text)(const CommandText& root, const SettingRows& settings);
};
constexpr std::array kShells{Shell{"bash", bash_completion}, Shell{"zsh", zsh_completion},
                             Shell{"fish", fish_completion}};

std::vector<std::string> shell_names() {
  std::vector<std::string> names;
  names.reserve(kShells.size());
  for (const Shell& shell : kShells) names.emplace_back(shell.name);
  return names;
}

// The date of a page: that of SOURCE_DATE_EPOCH, which packagers set so that a build gives the same bytes on any day,
// else of the commit. Never today's.
std::string page_date(const BuildStamp& build) {
  const char* const text = std::getenv("SOURCE_DATE_EPOCH");
  if (text == nullptr || *text == '\0') return std::string(build.date);
  const std::string_view digits(text);
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seconds);
  constexpr std::int64_t kYear10000_s = 253402300800;
  if (error != std::errc{} || end != digits.data() + digits.size() || seconds < 0 || seconds >= kYear10000_s) {
    throw UsageError(fmt::format("SOURCE_DATE_EPOCH: '{}' is no number of seconds since 1970", text));
  }
  const std::chrono::sys_days day =
      std::chrono::floor<std::chrono::days>(std::chrono::sys_seconds{std::chrono::seconds{seconds}});
  const std::chrono::year_month_day date{day};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

// In folders by section, as man looks for them.
void write_pages(const std::vector<ManPage>& pages, const std::string& folder) {
  for (const ManPage& page : pages) {
    const fs::path section = fs::path(folder) / ("man" + std::to_string(page.section));
    std::error_code error;
    fs::create_directories(section, error);
    if (error) throw FileError(section.string(), "cannot be created: " + error.message());
    write_file_atomically((section / page.file()).string(), page.text);
  }
}

int generate_man(CLI::App& root, const ManOptions& options, const BuildStamp& build) {
  const std::vector<ManPage> pages = man_pages(command_text(root), {GDTSLAM_VERSION, page_date(build)});
  if (!options.folder.empty()) {
    write_pages(pages, options.folder);
    return static_cast<int>(ExitCode::kDone);
  }
  std::vector<std::string> names;
  std::string list;
  for (const ManPage& page : pages) {
    if (page.name == options.page && !options.list) {
      print_result(page.text);
      return static_cast<int>(ExitCode::kDone);
    }
    names.push_back(page.name);
    list += page.file() + "\n";
  }
  if (!options.list) {
    throw UsageError("there is no page '" + options.page + "'" + did_you_mean(options.page, names) +
                     " (see 'gdtslam generate man --list')");
  }
  print_result(list);
  return static_cast<int>(ExitCode::kDone);
}

int generate_completion(CLI::App& root, const CompletionOptions& options) {
  for (const Shell& shell : kShells) {
    if (shell.name != options.shell) continue;
    Settings settings;
    const std::string text = shell.text(command_text(root), option_rows(settings, ""));
    if (options.file.empty()) {
      print_result(text);
    } else {
      write_file_atomically(options.file, text);
    }
    return static_cast<int>(ExitCode::kDone);
  }
  throw UsageError("there are no completions for '" + options.shell + "'" + did_you_mean(options.shell, shell_names()) +
                   ": bash, zsh or fish");
}

void add_man_command(CLI::App& root, CLI::App& parent, CommandContext& context) {
  auto options = std::make_shared<ManOptions>();
  CLI::App* command = add_command(parent, "man", "Manual pages of the command, its options and its files");
  CLI::Option* page = command->add_option("page", options->page, "The page to print");
  page->type_name("PAGE")->capture_default_str();
  command->add_option("-o,--output", options->folder, "Folder that all pages are written to, in man1 and man5")
      ->type_name("DIR")
      ->excludes(page);
  command->add_flag("--list", options->list, "List the pages, each with its section of the manual");
  command->footer(
      "A page for each command (section 1), gdtslam-options(5) and gdtslam-formats(5). The date on them is that of "
      "SOURCE_DATE_EPOCH, else of the commit that gdtslam was built from.\n"
      "\n"
      "Examples:\n"
      "  gdtslam generate man gdtslam-map | man -l -\n"
      "  gdtslam generate man -o ~/.local/share/man");
  command->callback([&root, options, &context] {
    context.run = [&root, options, build = context.build] { return generate_man(root, *options, build); };
  });
}

void add_completion_command(CLI::App& root, CLI::App& parent, CommandContext& context) {
  auto options = std::make_shared<CompletionOptions>();
  CLI::App* command = add_command(parent, "completion", "What a shell completes when TAB is pressed");
  CLI::Option* shell = command->add_option("shell", options->shell, "The shell: bash, zsh or fish");
  offer_words(shell->type_name("SHELL")->required(), shell_names());
  command->add_option("-o,--output", options->file, "File that is written, in place of standard output")
      ->type_name("FILE");
  command->footer(
      "Examples:\n"
      "  source <(gdtslam generate completion bash)\n"
      "  gdtslam generate completion zsh -o ~/.zsh/functions/_gdtslam\n"
      "  gdtslam generate completion fish -o ~/.config/fish/completions/gdtslam.fish");
  command->callback(
      [&root, options, &context] { context.run = [&root, options] { return generate_completion(root, *options); }; });
}

}  // namespace

void add_generate_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = add_command(app, "generate", "Manual pages, and completions for bash, zsh and fish");
  command->require_subcommand(1);
  add_man_command(app, *command, context);
  add_completion_command(app, *command, context);
  command->footer("Examples:\n  gdtslam generate man --list\n  gdtslam generate completion bash");
}

}  // namespace gdtslam
