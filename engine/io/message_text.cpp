#include "message_text.hpp"

namespace gdtslam {

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxShown = 48;
  return '"' + one_line(text, kMaxShown) + '"';
}

}  // namespace gdtslam
