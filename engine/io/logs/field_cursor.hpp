// Reads the blank-separated fields of a line in order. Not thread-safe.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "engine/io/decimal.hpp"
#include "engine/io/message_text.hpp"

namespace gdtslam {

/// A line that breaks its format; what() states the fault.
class MalformedLine : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class FieldCursor {
 public:
  explicit FieldCursor(std::string_view text) : position_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] bool at_end() {
    skip_blanks();
    return position_ == end_;
  }
  [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - position_); }

  std::string_view word(std::string_view name) {
    const std::string_view text = next_word();
    if (text.empty()) {
      throw MalformedLine(fmt::format("ends before its {}", name));
    }
    return text;
  }

  /// Reads any number, including infinity and NaN.
  double number(std::string_view name) {
    skip_blanks();
    number_ = position_;
    double value = 0.0;
    const char* const stop = parse_double(position_, end_, value);
    if (stop == nullptr || (stop != end_ && !is_blank(*stop))) {
      fail(name, "a number");
    }
    position_ = stop;
    return value;
  }
  double finite(std::string_view name) {
    const char* const start = position_;
    const double value = number(name);
    if (!std::isfinite(value)) {
      position_ = start;
      fail(name, "a finite number");
    }
    return value;
  }
  /// Decimal places of the last number, corrected for its exponent.
  [[nodiscard]] int decimals() const {
    return count_decimals({number_, static_cast<std::size_t>(position_ - number_)});
  }
  std::int64_t integer(std::string_view name) {
    skip_blanks();
    std::int64_t value = 0;
    const char* const stop = parse_int64(position_, end_, value);
    if (stop == nullptr || (stop != end_ && !is_blank(*stop))) {
      fail(name, "a whole number");
    }
    position_ = stop;
    return value;
  }
  void expect_end() {
    if (!at_end()) {
      throw MalformedLine(fmt::format("goes on with {} where it should end; does its number of beams agree with it?",
                                      in_quotes(next_word())));
    }
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  void skip_blanks() {
    while (position_ != end_ && is_blank(*position_)) {
      ++position_;
    }
  }
  std::string_view next_word() {
    skip_blanks();
    const char* const start = position_;
    while (position_ != end_ && !is_blank(*position_)) {
      ++position_;
    }
    return {start, static_cast<std::size_t>(position_ - start)};
  }
  static int count_decimals(std::string_view number) {
    const std::size_t exponent = std::min(number.find_first_of("eE"), number.size());
    const std::size_t point = std::min(number.find('.'), exponent);
    int decimals = std::max(0, static_cast<int>(exponent) - static_cast<int>(point) - 1);
    double power = 0.0;
    if (exponent < number.size()) {
      parse_double(number.data() + exponent + 1, number.data() + number.size(), power);
    }
    return decimals - static_cast<int>(std::clamp(power, -400.0, 400.0));
  }
  [[noreturn]] void fail(std::string_view name, std::string_view wanted) {
    const std::string_view text = word(name);
    throw MalformedLine(fmt::format("has {} as its {}, which is not {}", in_quotes(text), name, wanted));
  }

  const char* position_;
  const char* end_;
  const char* number_ = position_;
};

}  // namespace gdtslam
