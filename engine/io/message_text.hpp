// Text from files and from the system for messages: one line, printable, short. Thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <system_error>

#include "engine/core/one_line.hpp"

namespace gdtslam {

/// A short piece in quotation marks.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxShown = 48;
  return '"' + one_line(text, kMaxShown) + '"';
}

/// The system's text of an error number, independent of the locale's thread-unsafe strerror.
inline std::string errno_text(int code) { return std::generic_category().message(code); }

}  // namespace gdtslam
