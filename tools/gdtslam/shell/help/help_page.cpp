#include "help_page.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <sstream>

namespace gdtslam {
namespace {

constexpr std::size_t kUnknownWidth = 80;
constexpr std::size_t kLeastWidth = 40;
constexpr std::size_t kMostWidth = 100;
constexpr std::size_t kIndent = 2;
constexpr std::size_t kContinued = 6;  // indent of a continued command line and of its remark

std::optional<std::size_t> environment_width() {
  const char* const text = std::getenv("COLUMNS");
  if (text == nullptr) return std::nullopt;
  const std::string_view digits(text);
  std::size_t columns = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), columns);
  if (error != std::errc{} || end != digits.data() + digits.size() || columns == 0) return std::nullopt;
  return columns;
}

std::optional<std::size_t> terminal_width() {
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 1 || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return std::nullopt;
  }
  return size.ws_col;
}

// Number of characters: bytes of UTF-8 that begin one.
std::size_t letters_in(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string blanks(std::size_t count) { return std::string(count, ' '); }

void append_wrapped(std::string& page, std::string_view text, std::size_t indent, std::size_t width) {
  for (const std::string& line : wrapped(text, width - indent)) page += blanks(indent) + line + "\n";
}

// A name on the left and a text on the right, which starts on the next line if the name is long.
void append_row(std::string& page, const std::string& name, const std::string& text, std::size_t column,
                std::size_t width) {
  std::string row = blanks(kIndent) + name;
  const std::vector<std::string> lines = wrapped(text, width - column);
  std::size_t first = 0;
  if (letters_in(row) + 2 <= column && !lines.empty()) {
    row += blanks(column - letters_in(row)) + lines.front();
    first = 1;
  }
  page += row + "\n";
  for (std::size_t k = first; k < lines.size(); ++k) page += blanks(column) + lines[k] + "\n";
}

std::string left_column(const OptionText& option) {
  std::string left;
  for (const std::string& name : option.names) left += (left.empty() ? "" : ", ") + name;
  const bool is_argument = !option.names.front().starts_with('-');
  if (!option.value.empty() && !is_argument) left += " " + option.value;
  if (option.repeats) left += " ...";
  return left;
}

std::string right_column(const OptionText& option) {
  const std::string facts = option_facts(option);
  return facts.empty() ? option.doc : option.doc + " (" + facts + ")";
}

void append_options(std::string& page, const std::string& title, const std::vector<OptionText>& options,
                    std::size_t width) {
  if (options.empty()) return;
  const std::size_t column = std::clamp<std::size_t>(width * 3 / 10, 16, 28);
  page += "\n" + title + ":\n";
  for (const OptionText& option : options) append_row(page, left_column(option), right_column(option), column, width);
}

void append_commands(std::string& page, const std::vector<CommandText>& commands, std::size_t width) {
  std::vector<std::string> groups;
  std::size_t longest = 0;
  for (const CommandText& command : commands) {
    if (std::find(groups.begin(), groups.end(), command.group) == groups.end()) groups.push_back(command.group);
    longest = std::max(longest, command.name.size());
  }
  for (const std::string& group : groups) {
    page += "\n" + group + ":\n";
    for (const CommandText& command : commands) {
      if (command.group == group) append_row(page, command.name, command.doc, kIndent + longest + 2, width);
    }
  }
}

std::string usage_line(const CommandText& command) {
  std::string usage = "Usage: " + command.path;
  if (!command.groups.empty()) usage += " [OPTIONS]";
  for (const OptionText& argument : command.arguments) {
    const std::string name = argument.names.front() + (argument.repeats ? "..." : "");
    usage += argument.is_required ? " " + name : " [" + name + "]";
  }
  return command.commands.empty() ? usage : usage + " COMMAND";
}

// The words of a command line; quoted text is one word.
std::vector<std::string> words_of_command(std::string_view line) {
  std::vector<std::string> words;
  char quote = 0;
  bool in_word = false;
  for (const char c : line) {
    if (quote == 0 && c == ' ') {
      in_word = false;
      continue;
    }
    if (!in_word) words.emplace_back();
    in_word = true;
    words.back() += c;
    if (quote == c) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
    }
  }
  return words;
}

// A command line that is too long continues after a backslash, so that it can still be copied.
void append_command_line(std::string& page, std::string_view command, std::size_t width) {
  std::string line = blanks(kIndent);
  bool is_empty = true;
  for (const std::string& word : words_of_command(command)) {
    if (!is_empty && letters_in(line) + 1 + letters_in(word) + 2 > width) {
      page += line + " \\\n";
      line = blanks(kContinued);
      is_empty = true;
    }
    line += (is_empty ? "" : " ") + word;
    is_empty = false;
  }
  page += line + "\n";
}

// "gdtslam render intel       a picture of it": the remark goes below the command if the line has no room.
void append_example(std::string& page, const std::string& example, std::size_t width) {
  if (kIndent + letters_in(example) <= width) {
    page += blanks(kIndent) + example + "\n";
    return;
  }
  const std::size_t gap = example.find("   ", example.find_first_not_of(' '));
  append_command_line(page, std::string_view(example).substr(0, gap), width);
  if (gap == std::string::npos) return;
  const std::size_t remark = example.find_first_not_of(' ', gap);
  if (remark != std::string::npos) append_wrapped(page, "# " + example.substr(remark), kContinued, width);
}

void append_notes(std::string& page, const std::vector<Paragraph>& notes, std::size_t width) {
  for (const Paragraph& note : notes) {
    page += "\n";
    append_wrapped(page, note.text, 0, width);
    for (const std::string& line : note.lines) append_example(page, line, width);
  }
}

}  // namespace

std::size_t help_width() {
  const std::size_t width = environment_width().value_or(terminal_width().value_or(kUnknownWidth));
  return std::clamp(width, kLeastWidth, kMostWidth);
}

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    if (lines.empty() || letters_in(lines.back()) + 1 + letters_in(word) > width) {
      lines.push_back(word);
    } else {
      lines.back() += " " + word;
    }
  }
  return lines;
}

std::string help_page(const CommandText& command, std::size_t width) {
  std::string page;
  append_wrapped(page, command.doc, 0, width);
  append_wrapped(page, usage_line(command), 0, width);
  append_options(page, "Arguments", command.arguments, width);
  for (const OptionGroup& group : command.groups) append_options(page, group.title, group.options, width);
  append_commands(page, command.commands, width);
  append_notes(page, command.notes, width);
  if (!command.examples.empty()) page += "\nExamples:\n";
  for (const std::string& example : command.examples) append_example(page, example, width);
  append_notes(page, command.end_notes, width);
  return page;
}

}  // namespace gdtslam
