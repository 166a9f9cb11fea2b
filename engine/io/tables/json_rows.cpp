#include "json_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/decimal.hpp"
#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr int kDeepestSkipped = 16;
constexpr double kNullInList = std::numeric_limits<double>::infinity();  // as which null is read in a list

/// Reads what it expects, and says what is there instead.
class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : position_(text.data()), end_(text.data() + text.size()) {}

  /// True where the next character is this one, which is then behind.
  bool takes(char wanted) {
    skip_blanks();
    if (position_ == end_ || *position_ != wanted) return false;
    ++position_;
    return true;
  }
  void expect(char wanted) {
    if (!takes(wanted)) fail(fmt::format("'{}'", wanted));
  }
  [[nodiscard]] bool at_end() {
    skip_blanks();
    return position_ == end_;
  }
  /// Also null, NaN and Infinity.
  double number(std::string_view key) {
    if (takes_word("null")) return std::numeric_limits<double>::quiet_NaN();
    double value = 0.0;
    const char* const stop = parse_double(position_, end_, value);
    if (stop == nullptr) fail(fmt::format("a number as its {}", key));
    position_ = stop;
    return value;
  }
  std::int64_t whole(std::string_view key) {
    skip_blanks();
    std::int64_t value = 0;
    const char* const stop = parse_int64(position_, end_, value);
    if (stop == nullptr || (stop != end_ && (*stop == '.' || *stop == 'e' || *stop == 'E'))) {
      fail(fmt::format("a whole number as its {}", key));
    }
    position_ = stop;
    return value;
  }
  std::string text() {
    expect('"');
    std::string text;
    while (position_ != end_ && *position_ != '"') {
      text += *position_ == '\\' ? escaped() : std::string(1, *position_);
      ++position_;
    }
    expect('"');
    return text;
  }
  /// Numbers in arrays, however deep these are nested.
  void numbers(std::string_view key, std::vector<double>& values, int depth = 0) {
    if (depth > 1) fail(fmt::format("numbers or pairs of them in its {}", key));
    expect('[');
    if (takes(']')) return;
    do {
      skip_blanks();
      if (position_ != end_ && *position_ == '[') {
        numbers(key, values, depth + 1);
      } else {
        values.push_back(takes_word("null") ? kNullInList : number(key));
      }
    } while (takes(','));
    expect(']');
  }
  /// A value of any kind, which nobody wants.
  void skip_value(int depth = 0) {
    if (depth > kDeepestSkipped) fail("fewer brackets in brackets");
    skip_blanks();
    const char next = position_ == end_ ? '\0' : *position_;
    if (next == '"') {
      (void)text();
    } else if (next == '[' || next == '{') {
      ++position_;
      skip_members(next == '{', depth);
    } else if (!takes_word("true") && !takes_word("false")) {
      (void)number("value");
    }
  }
  [[noreturn]] void fail(const std::string& wanted) {
    skip_blanks();
    if (position_ == end_) throw MalformedRow(fmt::format("ends where {} should be", wanted));
    const auto left = static_cast<std::size_t>(end_ - position_);
    throw MalformedRow(
        fmt::format("has {} where {} should be", in_quotes({position_, std::min<std::size_t>(left, 24)}), wanted));
  }

 private:
  void skip_blanks() {
    while (position_ != end_ && (*position_ == ' ' || *position_ == '\t' || *position_ == '\r')) ++position_;
  }
  bool takes_word(std::string_view word) {
    skip_blanks();
    if (!std::string_view(position_, static_cast<std::size_t>(end_ - position_)).starts_with(word)) return false;
    position_ += word.size();
    return true;
  }
  void skip_members(bool is_object, int depth) {
    const char close = is_object ? '}' : ']';
    if (takes(close)) return;
    do {
      if (is_object) {
        (void)text();
        expect(':');
      }
      skip_value(depth + 1);
    } while (takes(','));
    expect(close);
  }
  /// What stands for the character behind a backslash; position_ ends on the last of it.
  std::string escaped() {
    if (++position_ == end_) fail("a character behind the backslash");
    constexpr std::string_view kLetters = "ntrbf";
    constexpr std::string_view kMeanings = "\n\t\r\b\f";
    if (*position_ != 'u') {
      const std::size_t at = kLetters.find(*position_);
      return std::string(1, at == std::string_view::npos ? *position_ : kMeanings[at]);
    }
    for (int digit = 0; digit < 4; ++digit) {
      if (++position_ == end_) fail("four digits behind \\u");
    }
    return "?";  // names and values of parameters are ASCII in every log known
  }

  const char* position_;
  const char* end_;
};

void read_pose(JsonCursor& cursor, std::string_view key, std::array<TableNumber, 3> numbers, TableRow& row) {
  std::vector<double> values;
  cursor.numbers(key, values);
  if (values.size() != numbers.size()) {
    throw MalformedRow(fmt::format("has {} numbers as its {}, which is x, y and theta", values.size(), key));
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) row[numbers[k]] = values[k];
}

void read_member(JsonCursor& cursor, const std::string& key, TableRow& row, const RowParser::Warn& warn) {
  if (key == kOdomKey) {
    read_pose(cursor, key, {TableNumber::kX, TableNumber::kY, TableNumber::kTheta}, row);
  } else if (key == kMountKey) {
    read_pose(cursor, key, {TableNumber::kLaserX, TableNumber::kLaserY, TableNumber::kLaserTheta}, row);
  } else if (const auto list = table_list(key)) {
    const bool is_ranges = *list == TableList::kRanges;
    (is_ranges ? row.has_ranges : row.has_points) = true;
    cursor.numbers(key, is_ranges ? row.ranges_m : row.points_m);
  } else if (const auto text = table_text(key)) {
    (*text == TableText::kName ? row.name.emplace() : row.value) = cursor.text();
  } else if (const auto number = table_number(key)) {
    if (*number == TableNumber::kTicks) {
      row.ticks = cursor.whole(key);
    } else {
      row[*number] = cursor.number(key);
    }
  } else if (const std::string hint = table_hint(key); !hint.empty()) {
    throw MalformedRow(fmt::format("has a key {}{}", in_quotes(key), hint));
  } else {
    warn("key not used", in_quotes(key));
    cursor.skip_value();
  }
}

}  // namespace

bool JsonRows::parse(std::string_view line, TableRow& row, const Warn& warn) {
  JsonCursor cursor(line);
  cursor.expect('{');
  if (!cursor.takes('}')) {
    do {
      const std::string key = cursor.text();
      cursor.expect(':');
      read_member(cursor, key, row, warn);
    } while (cursor.takes(','));
    cursor.expect('}');
  }
  if (!cursor.at_end()) cursor.fail("the end of the line");
  return true;
}

}  // namespace gdtslam
