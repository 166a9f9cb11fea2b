#include "completion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gdtslam {
namespace {

void add_missing(std::vector<std::string>& all, const std::vector<std::string>& more) {
  for (const std::string& word : more) {
    if (std::find(all.begin(), all.end(), word) == all.end()) all.push_back(word);
  }
}

void add_commands_from(std::vector<const CommandText*>& all, const CommandText& command) {
  if (command.group == kMissingCommands) return;
  all.push_back(&command);
  for (const CommandText& below : command.commands) add_commands_from(all, below);
}

}  // namespace

std::vector<const CommandText*> commands_from(const CommandText& root) {
  std::vector<const CommandText*> all;
  add_commands_from(all, root);
  return all;
}

std::vector<const OptionText*> options_in(const CommandText& command) {
  std::vector<const OptionText*> all;
  for (const OptionGroup& group : command.groups) {
    for (const OptionText& option : group.options) all.push_back(&option);
  }
  return all;
}

Offers offers_of_arguments(const CommandText& command) {
  Offers all;
  bool is_any_file = false;
  for (const OptionText& argument : command.arguments) {
    const Offers& offers = argument.offers;
    add_missing(all.words, offers.words);
    add_missing(all.endings, offers.endings);
    is_any_file = is_any_file || (offers.has_files && offers.endings.empty());
    all.has_files = all.has_files || offers.has_files;
    all.has_folders = all.has_folders || offers.has_folders;
  }
  if (is_any_file) all.endings.clear();
  return all;
}

std::string quoted_for_shell(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

std::string spaced(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

}  // namespace gdtslam
