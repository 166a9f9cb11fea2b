// The numbers of one line of an ASCII cloud, which blanks separate. Thread-safe.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

#include "cloud_file_layout.hpp"
#include "engine/io/decimal.hpp"

namespace gdtslam {

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
