#include "one_line.hpp"

namespace gdtslam {

std::string one_line(std::string_view text, std::size_t limit) {
  std::string shown;
  for (const char c : text.substr(0, limit)) {
    shown += c >= ' ' && c <= '~' ? c : '?';
  }
  return text.size() > limit ? shown + "..." : shown;
}

}  // namespace gdtslam
