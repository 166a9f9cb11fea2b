#include "command_tree.hpp"

#include <CLI/App.hpp>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::string_view kOptions = "Options";
constexpr std::string_view kExampleHeading = "Examples:";

std::vector<std::string> validator_texts(CLI::Option& option) {
  std::vector<std::string> texts;
  try {
    for (int k = 0;; ++k) texts.push_back(option.get_validator(k)->get_description());
  } catch (const CLI::OptionNotFound&) {  // CLI11's sign that there are no more
  }
  return texts;
}

// CLI11 writes "N:INT in [1 - 100]": the value's name, then each validator's description.
std::string find_value_name(CLI::Option& option, const std::vector<std::string>& validators) {
  if (option.get_items_expected_max() == 0) return {};
  std::size_t behind = 0;
  for (const std::string& text : validators) behind += text.empty() ? 0 : text.size() + 1;
  const std::string name = option.get_type_name();
  return name.substr(0, name.size() - std::min(behind, name.size()));
}

// Turns "INT in [1 - 100]" of CLI::Range into "1 to 100".
std::string find_bounds(const std::vector<std::string>& validators) {
  for (const std::string& text : validators) {
    const std::size_t begin = text.find(" in [");
    const std::size_t middle = text.find(" - ", begin == std::string::npos ? 0 : begin);
    if (begin == std::string::npos || middle == std::string::npos || text.back() != ']') continue;
    const std::size_t number = begin + 5;
    return text.substr(number, middle - number) + " to " + text.substr(middle + 3, text.size() - middle - 4);
  }
  return {};
}

// Cuts "(default: X)" or "[X]" off the end of a text.
std::string cut_default(std::string& doc) {
  const auto cut = [&doc](std::string_view open, char close) -> std::string {
    const std::size_t at = doc.rfind(open);
    if (at == std::string::npos || doc.back() != close) return {};
    std::string inside = doc.substr(at + open.size(), doc.size() - at - open.size() - 1);
    doc.resize(at);
    while (doc.ends_with(' ')) doc.pop_back();
    return inside;
  };
  std::string found = cut("(default: ", ')');
  return found.empty() ? cut(" [", ']') : found;
}

OptionText option_text(CLI::Option& option) {
  OptionText text;
  const std::vector<std::string> validators = validator_texts(option);
  if (option.get_positional()) {
    text.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  text.value = find_value_name(option, validators);
  text.doc = option.get_description();
  std::replace(text.doc.begin(), text.doc.end(), '\n', ' ');
  text.default_text = cut_default(text.doc);
  if (!option.get_default_str().empty()) text.default_text = option.get_default_str();
  text.bounds = find_bounds(validators);
  for (const CLI::Option* other : option.get_needs()) text.needs.push_back(other->get_name());
  text.is_required = option.get_required();
  text.repeats = !text.value.empty() && option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  text.offers = find_offers(option, text.value);
  return text;
}

std::vector<OptionGroup> collect_groups(CLI::App& app) {
  std::vector<OptionGroup> groups;
  for (CLI::Option* option : app.get_options()) {
    const std::string title = option->get_group();
    if (title.empty() || option->get_positional()) continue;
    auto found =
        std::find_if(groups.begin(), groups.end(), [&title](const OptionGroup& g) { return g.title == title; });
    if (found == groups.end()) found = groups.insert(groups.end(), {title, {}});
    found->options.push_back(option_text(*option));
  }
  std::stable_partition(groups.begin(), groups.end(), [](const OptionGroup& g) { return g.title == kOptions; });
  return groups;
}

// Lines that begin with two blanks are kept unchanged; others form one paragraph up to a blank line.
std::vector<Paragraph> split_paragraphs(const std::string& footer) {
  std::vector<Paragraph> paragraphs;
  bool is_open = false;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      is_open = false;
      continue;
    }
    const bool is_kept = line.starts_with("  ");
    if (!is_open || (!is_kept && !paragraphs.back().lines.empty())) {
      paragraphs.emplace_back();
      is_open = true;
    }
    Paragraph& last = paragraphs.back();
    if (is_kept) {
      last.lines.push_back(line.substr(2));
    } else {
      last.text += (last.text.empty() ? "" : " ") + line;
    }
  }
  return paragraphs;
}

std::string path_from_root(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : path_from_root(*app.get_parent()) + " " + app.get_name();
}

}  // namespace

CommandText command_text(CLI::App& app) {
  CommandText text;
  text.path = path_from_root(app);
  text.name = app.get_name();
  text.doc = app.get_description();
  text.group = app.get_group();
  for (CLI::Option* option : app.get_options()) {
    if (option->get_positional() && !option->get_group().empty()) text.arguments.push_back(option_text(*option));
  }
  text.groups = collect_groups(app);
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    if (!command->get_group().empty()) text.commands.push_back(command_text(*command));
  }
  for (Paragraph& paragraph : split_paragraphs(app.get_footer())) {
    if (paragraph.text == kExampleHeading) {
      text.examples = std::move(paragraph.lines);
    } else {
      (text.examples.empty() ? text.notes : text.end_notes).push_back(std::move(paragraph));
    }
  }
  return text;
}

std::string option_facts(const OptionText& option) {
  std::string facts;
  const auto add = [&facts](const std::string& fact) { facts += (facts.empty() ? "" : "; ") + fact; };
  if (!option.default_text.empty()) add("default: " + option.default_text);
  if (!option.bounds.empty()) add(option.bounds);
  if (option.is_required) add("required");
  for (const std::string& name : option.needs) add("with " + name);
  return facts;
}

}  // namespace gdtslam
