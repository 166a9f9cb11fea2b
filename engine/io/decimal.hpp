// Decimal numbers from text by std::from_chars, correctly rounded and independent of the locale. Thread-safe.
#pragma once

#include <cstdint>

namespace gdtslam {

/// Parses a number that starts at `begin`, with signs, exponents, "inf" and "nan". Returns the first character after
/// it, or nullptr if there is no number. Values beyond the range of double become infinity or zero.
const char* parse_double(const char* begin, const char* end, double& value);

/// The same for a signed integer; nullptr also if it does not fit.
const char* parse_int64(const char* begin, const char* end, std::int64_t& value);

}  // namespace gdtslam
