#include "option_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "gdtslam/core/units.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

std::string shown_value(const Option& option) {
  const auto* const number = std::get_if<double*>(&option.value);
  return number != nullptr ? show_quantity(**number, option.unit) : value_text(option);
}

std::vector<std::string> list_choices(const Option& option) {
  if (std::holds_alternative<bool*>(option.value)) return {"true", "false"};
  const auto* const choice = std::get_if<Choice>(&option.value);
  if (choice == nullptr) return {};
  return {choice->names().begin(), choice->names().end()};
}

std::string allowed_text(const Option& option) {
  if (std::holds_alternative<bool*>(option.value)) return "true or false";
  if (const auto* choice = std::get_if<Choice>(&option.value))
    return fmt::format("{}", fmt::join(choice->names(), ", "));
  return show_quantity(option.min, option.unit) + " to " + show_quantity(option.max, option.unit);
}

bool holds(const std::vector<std::string>& paths, std::string_view path) {
  return std::find(paths.begin(), paths.end(), path) != paths.end();
}

}  // namespace

std::vector<OptionRow> option_rows(Settings& settings, const std::string& file) {
  Settings defaults;
  const std::vector<Option> table = option_table(settings);
  const std::vector<Option> default_table = option_table(defaults);
  std::vector<OptionRow> rows;
  for (std::size_t k = 0; k < table.size(); ++k) {
    const std::string origin = holds(settings.from_sets, table[k].path)   ? "--set"
                               : holds(settings.from_file, table[k].path) ? file
                                                                          : "default";
    rows.push_back({std::string(table[k].path), shown_value(table[k]), shown_value(default_table[k]),
                    allowed_text(table[k]), origin, std::string(table[k].doc), list_choices(table[k]),
                    value_text(table[k]), value_text(default_table[k]), table[k].audience == kAdvanced});
  }
  return rows;
}

}  // namespace gdtslam
