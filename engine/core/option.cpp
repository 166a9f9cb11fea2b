#include "gdtslam/core/option.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

namespace gdtslam {
namespace {

std::optional<double> read_number(const Option& option) {
  if (const auto* real = std::get_if<double*>(&option.value)) return **real;
  if (const auto* integer = std::get_if<std::int32_t*>(&option.value)) return static_cast<double>(**integer);
  return std::nullopt;
}

}  // namespace

bool Choice::set(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return false;
  set_(value_, static_cast<std::size_t>(std::distance(names_.begin(), found)));
  return true;
}

std::vector<std::string> violations(std::span<const Option> options) {
  std::vector<std::string> found;
  for (const Option& option : options) {
    const std::optional<double> value = read_number(option);
    if (!value || (*value >= option.min && *value <= option.max)) continue;
    found.push_back(std::string(option.path) + ": " + show_quantity(*value, option.unit) + " is not in " +
                    show_quantity(option.min, option.unit) + " to " + show_quantity(option.max, option.unit));
  }
  return found;
}

}  // namespace gdtslam
