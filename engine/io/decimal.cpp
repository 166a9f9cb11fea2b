#include "decimal.hpp"

#include <charconv>
#include <limits>
#include <system_error>

namespace gdtslam {
namespace {

/// from_chars sets no value for a number out of range; the sign of the exponent decides between infinity and zero.
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

}  // namespace

const char* parse_double(const char* begin, const char* end, double& value) {
  if (begin != end && *begin == '+') {
    ++begin;  // from_chars accepts no plus sign
    if (begin == end || *begin == '-' || *begin == '+') {
      return nullptr;
    }
  }
  const std::from_chars_result result = std::from_chars(begin, end, value, std::chars_format::general);
  if (result.ec == std::errc::invalid_argument) return nullptr;
  if (result.ec == std::errc::result_out_of_range) value = out_of_range_value(begin, result.ptr);
  return result.ptr;
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
