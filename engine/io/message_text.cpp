#include "message_text.hpp"

namespace gdtslam {

std::string one_line(std::string_view text, std::size_t limit) {
  std::string shown;
  for (const char c : text.substr(0, limit)) {
    shown += c >= ' ' && c <= '~' ? c : '?';
  }
  return text.size() > limit ? shown + "..." : shown;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxShown = 48;
  return '"' + one_line(text, kMaxShown) + '"';
}

}  // namespace gdtslam
