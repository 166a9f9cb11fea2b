// Text to the value of an option and back. No state. Thread-safe for options that no two threads share.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "gdtslam/core/option.hpp"

namespace gdtslam {

/// A value that fits its option but is not stored yet.
struct ParsedValue {
  std::variant<double, std::int32_t, bool, std::string_view>
      value;  ///< in the order of Option::value; a name of a Choice
};

/// Whether a length, an angle or a time may be a bare number, in metres, radians or seconds.
enum class BareNumber { kAllowed, kRefused };

/// Throws std::invalid_argument with "path: value: what is wrong".
ParsedValue parse_option_value(const Option& option, std::string_view text, BareNumber bare);
void store(const Option& option, const ParsedValue& parsed);

}  // namespace gdtslam
