// Words and numbers of a line, which blanks separate. Thread-safe.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "cloud_file_layout.hpp"
#include "engine/io/decimal.hpp"

namespace gdtslam {

/// The words of a line, which blanks separate.
inline std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = line.find_first_not_of(" \t");
  while (begin != std::string_view::npos) {
    const std::size_t end = line.find_first_of(" \t", begin);
    words.push_back(line.substr(begin, end - begin));
    begin = end == std::string_view::npos ? end : line.find_first_not_of(" \t", end);
  }
  return words;
}

/// A whole number from 0; nothing when the word is none or does not fit.
inline std::optional<std::uint64_t> count_of(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The numbers of one line of an ASCII cloud.
class CloudNumbers {
 public:
  explicit CloudNumbers(std::string_view line) : at_(line.data()), end_(line.data() + line.size()) {}

  /// Nothing at the end of the line, or where something else than a number stands. A float is rounded once, from its
  /// digits: by way of double the last bit may differ.
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

}  // namespace gdtslam
