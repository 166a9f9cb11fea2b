// Blank-separated words and numbers of a line, and the values of a row of a cloud or a mesh. One object belongs to one
// thread.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "cloud_file_layout.hpp"
#include "cloud_input.hpp"
#include "engine/io/decimal.hpp"

namespace gdtslam {

/// The blank-separated words of a line.
inline std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = line.find_first_not_of(" \t");
  while (begin != std::string_view::npos) {
    const std::size_t end = line.find_first_of(" \t", begin);
    words.push_back(line.substr(begin, end - begin));
    begin = end == std::string_view::npos ? end : line.find_first_not_of(" \t", end);
  }
  return words;
}

/// A whole number from 0; none if the word is no number or does not fit.
inline std::optional<std::uint64_t> parse_count(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The numbers of one line of an ASCII cloud.
class CloudNumbers {
 public:
  explicit CloudNumbers(std::string_view line) : at_(line.data()), end_(line.data() + line.size()) {}

  /// The next number; none at the end of the line or before another word. A float is rounded once, directly from its
  /// digits, because rounding through a double may change the last bit.
  std::optional<double> next(Scalar type) {
    skip_blanks();
    if (at_ == end_) return std::nullopt;
    double value = 0.0;
    const char* stop = nullptr;
    if (type == Scalar::kFloat) {
      float single = 0.0F;
      const auto [behind, error] = std::from_chars(at_, end_, single);
      if (error == std::errc{}) stop = behind;
      value = static_cast<double>(single);
    }
    if (stop == nullptr) stop = parse_double(at_, end_, value);  // a sign +, or out of float's range
    if (stop == nullptr || (stop != end_ && !is_blank(*stop))) return std::nullopt;
    at_ = stop;
    return value;
  }
  bool at_end() {
    skip_blanks();
    return at_ == end_;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t'; }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }

  const char* at_;
  const char* end_;
};

/// The values of rows in order, from words of a line or from bytes.
class RowValues {
 public:
  RowValues(CloudInput& input, bool is_ascii, bool is_big_endian)
      : input_(input), is_ascii_(is_ascii), is_big_endian_(is_big_endian) {}
  /// Goes to the next non-blank line of a text; false at the end of the input.
  bool begin_row() {
    if (!is_ascii_) return true;
    std::optional<std::string_view> line = input_.line();
    while (line && line->find_first_not_of(" \t") == std::string_view::npos) line = input_.line();
    numbers_ = CloudNumbers(line.value_or(""));
    return line.has_value();
  }
  /// Calls take(column, number) for each value of a row of the element. Returns the fault of the row: kEndsEarly if
  /// bytes are missing, empty if there is none.
  template <class Take>
  std::string_view read(const CloudElement& element, const Take& take) {
    const std::string_view missing = is_ascii_ ? "has fewer numbers than columns, or a word among them" : kEndsEarly;
    for (const CloudColumn& column : element.columns) {
      auto items = static_cast<double>(column.repeat);
      if (column.list_count) {
        const std::optional<double> count = next(*column.list_count);
        if (!count) return missing;
        if (!(*count >= 0.0)) return "the length of a list is not a number from 0";
        items = *count;
      }
      for (double item = 0.0; item < items; ++item) {
        const std::optional<double> number = next(column.type);
        if (!number) return missing;
        take(column, *number);
      }
    }
    const bool is_at_end = !is_ascii_ || numbers_.at_end();
    return is_at_end ? std::string_view() : "has more numbers than columns, or a word among them";
  }
  static constexpr std::string_view kEndsEarly = "ends early";
  [[nodiscard]] bool is_ascii() const { return is_ascii_; }

 private:
  /// The next number; none at the end of the line or the input, or before another word.
  std::optional<double> next(Scalar type) {
    if (is_ascii_) return numbers_.next(type);
    const char* const data = input_.bytes(byte_size(type));
    return data == nullptr ? std::nullopt : std::optional(decode(type, data, is_big_endian_));
  }

  CloudInput& input_;
  bool is_ascii_;
  bool is_big_endian_;
  CloudNumbers numbers_{{}};
};

}  // namespace gdtslam
