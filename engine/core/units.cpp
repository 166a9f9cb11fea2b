#include "gdtslam/core/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>

#include "gdtslam/core/angle.hpp"
#include "one_line.hpp"

namespace gdtslam {
namespace {

// A symbol; its value in the base unit is factor * 10^power.
struct Symbol {
  std::string_view text;
  Unit unit;
  int power;
  double factor;
};

constexpr std::array<Symbol, 24> kSymbols = {{
    {"m", Unit::kMetre, 0, 1.0},
    {"km", Unit::kMetre, 3, 1.0},
    {"dm", Unit::kMetre, -1, 1.0},
    {"cm", Unit::kMetre, -2, 1.0},
    {"mm", Unit::kMetre, -3, 1.0},
    {"um", Unit::kMetre, -6, 1.0},
    {"\u00B5m", Unit::kMetre, -6, 1.0},
    {"rad", Unit::kRadian, 0, 1.0},
    {"mrad", Unit::kRadian, -3, 1.0},
    {"deg", Unit::kRadian, 0, kPi / 180.0},
    {"\u00B0", Unit::kRadian, 0, kPi / 180.0},
    {"turn", Unit::kRadian, 0, kTwoPi},
    {"turns", Unit::kRadian, 0, kTwoPi},
    {"s", Unit::kSecond, 0, 1.0},
    {"ms", Unit::kSecond, -3, 1.0},
    {"us", Unit::kSecond, -6, 1.0},
    {"\u00B5s", Unit::kSecond, -6, 1.0},
    {"ns", Unit::kSecond, -9, 1.0},
    {"min", Unit::kSecond, 0, 60.0},
    {"h", Unit::kSecond, 0, 3600.0},
    {"cell", Unit::kCell, 0, 1.0},
    {"cells", Unit::kCell, 0, 1.0},
    {"%", Unit::kShare, -2, 1.0},
    {"share", Unit::kShare, 0, 1.0},
}};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::size_t skip_digits(std::string_view text, std::size_t at) {
  while (at < text.size() && is_digit(text[at])) {
    ++at;
  }
  return at;
}

// A decimal number cut from the front of a text: sign, digits with at most one point, exponent.
struct NumberText {
  std::string_view mantissa;  ///< empty when the text starts with no number
  int exponent = 0;
  std::string_view rest;
};

NumberText cut_number(std::string_view text) {
  const std::size_t sign = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  const std::size_t point = skip_digits(text, sign);
  const bool has_point = point < text.size() && text[point] == '.';
  const std::size_t end = has_point ? skip_digits(text, point + 1) : point;
  if (end - sign == (has_point ? 1U : 0U)) {
    return {};
  }
  NumberText number{text.substr(text[0] == '+' ? 1 : 0, end - (text[0] == '+' ? 1 : 0)), 0, text.substr(end)};
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const std::size_t digits = end + 1 < text.size() && text[end + 1] == '+' ? end + 2 : end + 1;
    const auto [next, error] = std::from_chars(text.data() + digits, text.data() + text.size(), number.exponent);
    // An exponent so large that only zero stays in range; clamped, so that adding a unit's power cannot overflow.
    constexpr int kLargest = 1000000000;
    if (error == std::errc::result_out_of_range) {
      number.exponent = text[digits] == '-' ? -kLargest : kLargest;
    }
    number.exponent = std::clamp(number.exponent, -kLargest, kLargest);
    if (error != std::errc::invalid_argument) {
      number.rest = text.substr(static_cast<std::size_t>(next - text.data()));
    }
  }
  return number;
}

// mantissa * 10^exponent, correctly rounded, by handing the sum of the exponents to the decimal conversion.
std::optional<double> to_double(std::string_view mantissa, int exponent) {
  const std::string text = std::string(mantissa) + "e" + std::to_string(exponent);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

std::string list_symbols(Unit unit) {
  std::string list;
  for (const Symbol& symbol : kSymbols) {
    if (symbol.unit == unit) {
      list.append(list.empty() ? "" : ", ").append(symbol.text);
    }
  }
  return list;
}

std::optional<double> refuse(std::string* why, std::string reason) {
  if (why != nullptr) {
    *why = std::move(reason);
  }
  return std::nullopt;
}

// A quoted text from a file may contain anything.
std::string quoted(std::string_view text) {
  constexpr std::size_t kMostShown = 48;
  return "'" + one_line(text, kMostShown) + "'";
}

}  // namespace

std::string_view unit_symbol(Unit unit) {
  switch (unit) {
    case Unit::kMetre:
      return "m";
    case Unit::kRadian:
      return "rad";
    case Unit::kSecond:
      return "s";
    case Unit::kCell:
      return "cells";
    case Unit::kNone:
    case Unit::kShare:
      break;
  }
  return {};
}

std::optional<double> parse_quantity(std::string_view text, Unit unit, std::string* why) {
  const NumberText number = cut_number(trimmed(text));
  if (number.mantissa.empty()) {
    return refuse(why, quoted(text) + " does not start with a decimal number");
  }
  const std::string_view name = trimmed(number.rest);
  int power = 0;
  double factor = 1.0;
  if (!name.empty()) {
    const Symbol* found = nullptr;
    for (const Symbol& symbol : kSymbols) {
      if (symbol.text == name && symbol.unit == unit) {
        found = &symbol;
      }
    }
    if (found == nullptr) {
      const std::string known = list_symbols(unit);
      const std::string cure = known.empty() ? "write a bare number" : std::string("write one of ").append(known);
      return refuse(why, std::string("unit ").append(quoted(name)).append(" does not fit here; ").append(cure));
    }
    power = found->power;
    factor = found->factor;
  }
  const std::optional<double> value = to_double(number.mantissa, number.exponent + power);
  if (!value || !std::isfinite(*value * factor)) {
    return refuse(why, quoted(text) + " is beyond the range of double precision");
  }
  return *value * factor;
}

namespace {

// "5 cm, 5 m": the number with a small and a large unit; empty if there is only one unit.
std::string examples_with_units(std::string_view number, Unit unit) {
  const std::string text(number);
  switch (unit) {
    case Unit::kMetre:
      return text + " cm, " + text + " m";
    case Unit::kRadian:
      return text + " deg, " + text + " rad";
    case Unit::kSecond:
      return text + " ms, " + text + " s";
    case Unit::kNone:
    case Unit::kCell:
    case Unit::kShare:
      break;
  }
  return {};
}

}  // namespace

std::optional<double> parse_stated_quantity(std::string_view text, Unit unit, std::string* why) {
  const std::optional<double> value = parse_quantity(text, unit, why);
  if (!value || *value == 0.0 || !trimmed(cut_number(trimmed(text)).rest).empty()) return value;
  const std::string examples = examples_with_units(trimmed(text), unit);
  return examples.empty() ? value : refuse(why, quoted(trimmed(text)) + " needs a unit: " + examples);
}

namespace {

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), error == std::errc{} ? end : buffer.data()};
}

// A round number of degrees has endless decimals in radians. Empty if degrees would not read back as the same bits.
std::string in_degrees(double angle_rad) {
  constexpr double kDecimals = 1e6;
  const double angle_deg = std::round(deg_from_rad(angle_rad) * kDecimals) / kDecimals;
  std::string text = shortest(angle_deg) + " deg";
  const std::optional<double> back = parse_quantity(text, Unit::kRadian, nullptr);
  return back && *back == angle_rad && angle_deg != 0.0 ? text : std::string();
}

}  // namespace

std::string format_quantity(double value, Unit unit) {
  const std::string_view symbol = unit_symbol(unit);
  std::string text = shortest(value);
  if (!symbol.empty()) text.append(1, ' ').append(symbol);
  if (unit != Unit::kRadian) return text;
  std::string degrees = in_degrees(value);
  return !degrees.empty() && degrees.size() < text.size() ? degrees : text;
}

std::string show_quantity(double value, Unit unit) {
  constexpr int kDigits = 6;
  std::array<char, 64> buffer{};
  if (unit == Unit::kRadian) {
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), deg_from_rad(value),
                                            std::chars_format::general, kDigits);
    return std::string(buffer.data(), error == std::errc{} ? end : buffer.data()) + " deg";
  }
  constexpr double kMostInFull = 1e15;
  if (value != std::floor(value) || std::fabs(value) > kMostInFull) return format_quantity(value, unit);
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), static_cast<std::int64_t>(value));
  const std::string_view symbol = unit_symbol(unit);
  std::string text(buffer.data(), error == std::errc{} ? end : buffer.data());
  return symbol.empty() ? text : text.append(1, ' ').append(symbol);
}

}  // namespace gdtslam
