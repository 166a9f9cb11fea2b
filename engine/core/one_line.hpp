// Foreign text for messages: one line, printable, short. Thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gdtslam {

/// The text with '?' for everything except printable ASCII; cut at `limit` characters.
inline std::string one_line(std::string_view text, std::size_t limit = 200) {
  std::string shown;
  for (const char c : text.substr(0, limit)) {
    shown += c >= ' ' && c <= '~' ? c : '?';
  }
  return text.size() > limit ? shown + "..." : shown;
}

}  // namespace gdtslam
