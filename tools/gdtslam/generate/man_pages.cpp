#include "man_pages.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace gdtslam {
namespace {

constexpr std::string_view kExitCodes = "Exit codes: ";

std::string page_name(const CommandText& command) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string reference(std::string_view name, int section) { return bold(name) + "(" + std::to_string(section) + ")"; }

std::string lower_first(std::string text) {
  const bool is_word = text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0;
  if (is_word) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string sentence(const std::string& text) { return text.ends_with('.') || text.ends_with(':') ? text : text + "."; }

std::string tag_of(const OptionText& option) {
  std::string tag;
  for (const std::string& name : option.names) {
    const bool is_argument = !name.starts_with('-');
    tag += (tag.empty() ? "" : ", ") + (is_argument ? italic(name) : bold(name));
    if (!is_argument && !option.value.empty() && name == option.names.back()) tag += " " + italic(option.value);
  }
  return option.repeats ? tag + " ..." : tag;
}

std::string meaning_of(const OptionText& option) {
  const std::string facts = facts_of(option);
  return plain(sentence(option.doc) + (facts.empty() ? "" : " (" + facts + ")"));
}

void add_options(RoffPage& page, std::string_view heading, const std::vector<OptionText>& options) {
  if (options.empty()) return;
  page.section(heading);
  for (const OptionText& option : options) page.item(tag_of(option), meaning_of(option));
}

std::string synopsis_of(const CommandText& command) {
  std::string text = bold(command.path);
  if (!command.groups.empty()) text += " [" + italic("OPTIONS") + "]";
  for (const OptionText& argument : command.arguments) {
    const std::string name = italic(argument.names.front()) + (argument.repeats ? "..." : "");
    text += argument.is_required ? " " + name : " [" + name + "]";
  }
  return command.commands.empty() ? text : text + " " + italic("COMMAND");
}

bool is_here(const CommandText& command) { return command.group != kMissingCommands; }

void add_commands(RoffPage& page, const CommandText& command) {
  if (command.commands.empty()) return;
  page.section("Commands");
  std::string group;
  for (const CommandText& below : command.commands) {
    if (!is_here(below)) continue;
    const bool has_headings = below.group != command.commands.back().group || !group.empty();
    if (has_headings && below.group != group) page.subsection(below.group);
    group = below.group;
    page.item(reference(page_name(below), 1), plain(sentence(below.doc)));
  }
}

// "0 done; 1 failed while running": a code and what it means, separated by semicolons.
void add_exit_codes(RoffPage& page, std::string_view text) {
  page.section("Exit status");
  while (!text.empty()) {
    const std::size_t end = std::min(text.find("; "), text.size());
    const std::string_view entry = text.substr(0, end);
    const std::size_t blank = entry.find(' ');
    page.item(bold(entry.substr(0, blank)), plain(sentence(std::string(entry.substr(blank + 1)))));
    text.remove_prefix(std::min(end + 2, text.size()));
  }
}

void add_notes(RoffPage& page, const std::vector<Paragraph>& notes) {
  for (const Paragraph& note : notes) {
    if (note.text.starts_with(kExitCodes)) {
      add_exit_codes(page, std::string_view(note.text).substr(kExitCodes.size()));
      continue;
    }
    if (!note.text.empty()) page.paragraph(plain(note.text));
    if (!note.lines.empty()) page.code(note.lines);
  }
}

bool takes_settings(const CommandText& command) {
  return std::any_of(command.groups.begin(), command.groups.end(), [](const OptionGroup& group) {
    return std::any_of(group.options.begin(), group.options.end(),
                       [](const OptionText& option) { return option.offers.has_settings; });
  });
}

void add_see_also(RoffPage& page, const CommandText& command, const CommandText* parent) {
  page.section("See also");
  std::string text;
  const auto add = [&text](const std::string& name) { text += (text.empty() ? "" : ", ") + name; };
  if (parent != nullptr) add(reference(page_name(*parent), 1));
  if (parent != nullptr && parent->path != "gdtslam") add(reference("gdtslam", 1));
  if (parent == nullptr || takes_settings(command)) add(reference("gdtslam-options", 5));
  add(reference("gdtslam-formats", 5));
  page.paragraph(text);
}

ManPage page_of(const CommandText& command, const CommandText* parent, const PageStamp& stamp) {
  RoffPage page(page_name(command), 1, stamp, lower_first(command.doc));
  page.section("Synopsis");
  page.paragraph(synopsis_of(command));
  if (!command.notes.empty()) page.section("Description");
  add_notes(page, command.notes);
  add_options(page, "Arguments", command.arguments);
  for (const OptionGroup& group : command.groups) add_options(page, group.title, group.options);
  add_commands(page, command);
  if (!command.examples.empty()) {
    page.section("Examples");
    page.code(command.examples);
  }
  add_notes(page, command.end_notes);
  add_see_also(page, command, parent);
  return {page_name(command), 1, page.text()};
}

void add_pages(std::vector<ManPage>& pages, const CommandText& command, const CommandText* parent,
               const PageStamp& stamp) {
  pages.push_back(page_of(command, parent, stamp));
  for (const CommandText& below : command.commands) {
    if (is_here(below)) add_pages(pages, below, &command, stamp);
  }
}

}  // namespace

std::vector<ManPage> man_pages(const CommandText& root, const PageStamp& stamp) {
  std::vector<ManPage> pages;
  add_pages(pages, root, nullptr, stamp);
  pages.push_back(options_page(stamp));
  pages.push_back(formats_page(stamp));
  return pages;
}

}  // namespace gdtslam
