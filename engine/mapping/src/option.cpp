#include "gdtslam/mapping/option.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

namespace gdtslam {
namespace {

// The shortest text that reads back as the same number.
std::string text_of(double value) {
  char digits[32];
  const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
  return {digits, end};
}

std::string with_unit(double value, Unit unit) {
  const std::string symbol{symbol_of(unit)};
  return symbol.empty() ? text_of(value) : text_of(value) + " " + symbol;
}

std::optional<double> number_of(const Option& option) {
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
    const std::optional<double> value = number_of(option);
    if (!value || (*value >= option.min && *value <= option.max)) continue;
    found.push_back(std::string(option.path) + ": " + with_unit(*value, option.unit) + " is not in " +
                    with_unit(option.min, option.unit) + " to " + with_unit(option.max, option.unit));
  }
  return found;
}

}  // namespace gdtslam
