#include "decimal.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <system_error>

namespace gdtslam {
namespace {

constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kExactLimit = std::uint64_t{1} << 53;
constexpr int kMaxDigits = 19;  // what a uint64 holds whatever the digits are

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// from_chars leaves the value alone when it is out of range; the sign of the exponent tells which side.
double out_of_range_value(const char* begin, const char* end) {
  const bool negative = *begin == '-';
  bool tiny = false;
  bool seen_nonzero = false;
  for (const char* p = begin; p != end; ++p) {
    if (*p == 'e' || *p == 'E') {
      tiny = p + 1 != end && p[1] == '-';
      break;
    }
    if (*p == '.' && !seen_nonzero) {
      tiny = true;  // 0.000...: without an exponent only a fraction can be too small
    }
    seen_nonzero = seen_nonzero || (*p >= '1' && *p <= '9');
  }
  const double magnitude = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return negative ? -magnitude : magnitude;
}

const char* parse_slowly(const char* begin, const char* end, double& value) {
  const std::from_chars_result result = std::from_chars(begin, end, value, std::chars_format::general);
  if (result.ec == std::errc::invalid_argument) {
    return nullptr;
  }
  if (result.ec == std::errc::result_out_of_range) {
    value = out_of_range_value(begin, result.ptr);
  }
  return result.ptr;
}

}  // namespace

const char* parse_double(const char* begin, const char* end, double& value) {
  if (begin != end && *begin == '+') {
    ++begin;  // from_chars knows no plus sign
    if (begin == end || *begin == '-' || *begin == '+') {
      return nullptr;
    }
  }
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  p += negative ? 1 : 0;
  std::uint64_t mantissa = 0;
  const char* const digits = p;
  for (; p != end && is_digit(*p); ++p) {
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
  }
  auto digit_count = p - digits;
  std::ptrdiff_t fraction_digits = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    for (; p != end && is_digit(*p); ++p) {
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(*p - '0');
    }
    fraction_digits = p - fraction;
    digit_count += fraction_digits;
  }
  const bool has_exponent = p != end && (*p == 'e' || *p == 'E');
  if (digit_count == 0 || digit_count > kMaxDigits || mantissa > kExactLimit || has_exponent) {
    return parse_slowly(begin, end, value);
  }
  const double magnitude = static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(fraction_digits)];
  value = negative ? -magnitude : magnitude;
  return p;
}

const char* parse_int64(const char* begin, const char* end, std::int64_t& value) {
  if (begin != end && *begin == '+') {
    ++begin;
    if (begin == end || *begin == '-') {
      return nullptr;
    }
  }
  const std::from_chars_result result = std::from_chars(begin, end, value);
  return result.ec == std::errc{} ? result.ptr : nullptr;
}

}  // namespace gdtslam
