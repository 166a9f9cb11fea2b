// Decimal numbers from text by std::from_chars, correctly rounded and independent of the locale. Thread-safe.
#pragma once

#include <cstdint>

namespace gdtslam {

/// Parses a number that starts at `begin`; stops at the first character that is no part of it. Signs, exponents, "inf"
/// and "nan" are understood. Returns where it stopped, or nullptr when there is no number. Values beyond the range of
/// double become infinity or zero.
const char* parse_double(const char* begin, const char* end, double& value);

/// The same for a signed integer; nullptr also when it does not fit.
const char* parse_int64(const char* begin, const char* end, std::int64_t& value);

}  // namespace gdtslam
