// Text to the value of an option and back. No state. Thread-safe for options that no two threads share.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "gdtslam/mapping/option.hpp"

namespace gdtslam {

/// A value that fits its option but is not stored yet.
struct ParsedValue {
  std::variant<double, std::int32_t, bool, std::string_view>
      value;  ///< in the order of Option::value; a name of a Choice
};

/// Throws std::invalid_argument with "path: value: what is wrong".
ParsedValue parse_option_value(const Option& option, std::string_view text);
void store(const Option& option, const ParsedValue& parsed);

}  // namespace gdtslam
