#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/io/message_text.hpp"
#include "row_parser.hpp"

namespace gdtslam {
namespace {

using JsonLine = nlohmann::json;

constexpr int kDeepest = 18;  // nesting of brackets, which unused values may have
constexpr std::string_view kNan = "NaN";
constexpr std::string_view kInfinity = "Infinity";

/// The line as strict JSON: NaN and Infinity become texts, and -0 keeps its sign as a fraction.
std::string strict_json(std::string_view line) {
  std::string text;
  text.reserve(line.size());
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const std::string_view rest = line.substr(k);
    text += rest.front();
    if (is_quoted && rest.front() == '\\' && rest.size() > 1) {
      text += rest[1];
      ++k;
      continue;
    }
    is_quoted = is_quoted != (rest.front() == '"');
    if (is_quoted) continue;
    depth += rest.front() == '[' || rest.front() == '{' ? 1 : 0;
    depth -= rest.front() == ']' || rest.front() == '}' ? 1 : 0;
    if (depth > kDeepest) throw MalformedRow("has too many brackets in brackets");
    if (rest.starts_with("-0") && rest.substr(2, 1).find_first_of("0123456789.eE") == std::string_view::npos) {
      text += "0.0";
      ++k;
    }
    for (const std::string_view word : {kNan, kInfinity}) {
      if (!rest.starts_with(word)) continue;
      text.pop_back();
      const bool is_negative = text.ends_with('-');
      if (is_negative) text.pop_back();
      text += fmt::format("\"{}{}\"", is_negative ? "-" : "", word);
      k += word.size() - 1;
    }
  }
  return text;
}

[[noreturn]] void refuse(const JsonLine& value, const std::string& wanted) {
  const std::string shown = value.dump(-1, ' ', true, JsonLine::error_handler_t::replace);
  throw MalformedRow(fmt::format("has {} where {} should be", in_quotes(shown.substr(0, 24)), wanted));
}

double read_number(const JsonLine& value, std::string_view key, double of_null) {
  constexpr double kMost = std::numeric_limits<double>::infinity();
  if (value.is_number()) return value.get<double>();
  if (value.is_null()) return of_null;
  if (value == kNan) return std::numeric_limits<double>::quiet_NaN();
  if (value == kInfinity) return kMost;
  if (value == "-Infinity") return -kMost;
  refuse(value, fmt::format("a number as its {}", key));
}

std::int64_t read_whole(const JsonLine& value, std::string_view key) {
  const bool is_too_large = value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX;
  if (!value.is_number_integer() || is_too_large) refuse(value, fmt::format("a whole number as its {}", key));
  return value.get<std::int64_t>();
}

std::string read_text(const JsonLine& value, std::string_view key) {
  if (!value.is_string()) refuse(value, fmt::format("a text as its {}", key));
  return value.get<std::string>();
}

/// Numbers, or pairs of them. A null in a list is no return.
void append_numbers(const JsonLine& value, std::string_view key, std::vector<double>& numbers, int depth = 0) {
  if (!value.is_array() || depth > 1) refuse(value, fmt::format("numbers or pairs of them in its {}", key));
  for (const JsonLine& entry : value) {
    if (entry.is_array()) {
      append_numbers(entry, key, numbers, depth + 1);
    } else {
      numbers.push_back(read_number(entry, key, std::numeric_limits<double>::infinity()));
    }
  }
}

void read_pose(const JsonLine& value, std::string_view key, std::array<TableNumber, 3> numbers, TableRow& row) {
  std::vector<double> values;
  append_numbers(value, key, values);
  if (values.size() != numbers.size()) {
    throw MalformedRow(fmt::format("has {} numbers as its {}, which is x, y and theta", values.size(), key));
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) row[numbers[k]] = values[k];
}

void read_member(const JsonLine& value, const std::string& key, TableRow& row, const RowWarn& warn) {
  if (key == kOdomKey) {
    read_pose(value, key, {TableNumber::kX, TableNumber::kY, TableNumber::kTheta}, row);
  } else if (key == kMountKey) {
    read_pose(value, key, {TableNumber::kLaserX, TableNumber::kLaserY, TableNumber::kLaserTheta}, row);
  } else if (const auto list = table_list(key)) {
    const bool is_ranges = *list == TableList::kRanges;
    (is_ranges ? row.has_ranges : row.has_points) = true;
    append_numbers(value, key, is_ranges ? row.ranges_m : row.points_m);
  } else if (const auto text = table_text(key)) {
    (*text == TableText::kName ? row.name.emplace() : row.value) = read_text(value, key);
  } else if (const auto number = table_number(key)) {
    if (*number == TableNumber::kTicks) {
      row.ticks = read_whole(value, key);
    } else {
      row[*number] = read_number(value, key, std::numeric_limits<double>::quiet_NaN());
    }
  } else if (const std::string hint = table_hint(key); !hint.empty()) {
    throw MalformedRow(fmt::format("has a key {}{}", in_quotes(key), hint));
  } else {
    warn("key not used", in_quotes(key));
  }
}

}  // namespace

void parse_json_row(std::string_view line, TableRow& row, const RowWarn& warn) {
  const std::string text = strict_json(line);
  try {
    const JsonLine object = JsonLine::parse(text);
    if (!object.is_object()) refuse(object, "a JSON object");
    for (const auto& [key, value] : object.items()) read_member(value, key, row, warn);
  } catch (const JsonLine::parse_error& error) {
    const std::size_t at = std::max<std::size_t>(error.byte, 1) - 1;
    if (at >= text.size()) throw MalformedRow("ends before its JSON is complete");
    throw MalformedRow(fmt::format("is no JSON at {}", in_quotes(text.substr(at, 24))));
  } catch (const JsonLine::out_of_range&) {
    throw MalformedRow("has a number that no double can hold");
  }
}

}  // namespace gdtslam
