#include "option_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/core/shown_quantity.hpp"
#include "engine/core/stated_quantity.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

[[noreturn]] void refuse(const Option& option, std::string_view text, const std::string& reason) {
  throw std::invalid_argument(fmt::format("{}: {} {}", option.path, in_quotes(text), reason));
}

// A bound is taken as it is told, in six digits of a degree, too: it stands for the bound itself.
double within_told_bounds(const Option& option, double value) {
  for (const double bound : {option.min, option.max}) {
    if (show_quantity(value, option.unit) == show_quantity(bound, option.unit)) {
      return std::clamp(value, option.min, option.max);
    }
  }
  return value;
}

double parse_number(const Option& option, std::string_view text, BareNumber bare) {
  std::string why;
  const std::optional<double> value = bare == BareNumber::kRefused ? parse_stated_quantity(text, option.unit, &why)
                                                                   : parse_quantity(text, option.unit, &why);
  if (!value) {
    refuse(option, text, fmt::format("is no value of it: {}", why));
  }
  const double number = within_told_bounds(option, *value);
  if (number < option.min) {
    refuse(option, text, fmt::format("is below its minimum {}", show_quantity(option.min, option.unit)));
  }
  if (number > option.max) {
    refuse(option, text, fmt::format("is above its maximum {}", show_quantity(option.max, option.unit)));
  }
  return number;
}

std::int32_t parse_whole(const Option& option, std::string_view text, BareNumber bare) {
  const double value = parse_number(option, text, bare);
  if (value != std::floor(value) || std::fabs(value) > 2147483647.0) {
    refuse(option, text, "is no whole number");
  }
  return static_cast<std::int32_t>(value);
}

bool parse_bool(const Option& option, std::string_view text) {
  if (text != "true" && text != "false") {
    refuse(option, text, "is neither true nor false");
  }
  return text == "true";
}

std::string_view parse_choice(const Option& option, const Choice& choice, std::string_view text) {
  const auto names = choice.names();
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) {
    return *found;
  }
  const std::optional<std::string_view> nearest = nearest_name(text, names);
  refuse(option, text,
         fmt::format("is none of {}{}", fmt::join(names, ", "),
                     nearest ? fmt::format("; did you mean {}?", *nearest) : std::string()));
}

}  // namespace

ParsedValue parse_option_value(const Option& option, std::string_view text, BareNumber bare) {
  switch (option.value.index()) {
    case 0:
      return {parse_number(option, text, bare)};
    case 1:
      return {parse_whole(option, text, bare)};
    case 2:
      return {parse_bool(option, text)};
    default:
      return {parse_choice(option, std::get<Choice>(option.value), text)};
  }
}

void store(const Option& option, const ParsedValue& parsed) {
  switch (option.value.index()) {
    case 0:
      *std::get<double*>(option.value) = std::get<double>(parsed.value);
      break;
    case 1:
      *std::get<std::int32_t*>(option.value) = std::get<std::int32_t>(parsed.value);
      break;
    case 2:
      *std::get<bool*>(option.value) = std::get<bool>(parsed.value);
      break;
    default:
      std::get<Choice>(option.value).set(std::get<std::string_view>(parsed.value));
  }
}

std::string value_text(const Option& option) {
  switch (option.value.index()) {
    case 0:
      return format_quantity(*std::get<double*>(option.value), option.unit);
    case 1:
      return format_quantity(static_cast<double>(*std::get<std::int32_t*>(option.value)), option.unit);
    case 2:
      return *std::get<bool*>(option.value) ? "true" : "false";
    default:
      return std::string(std::get<Choice>(option.value).get());
  }
}

}  // namespace gdtslam
