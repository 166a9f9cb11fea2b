#include "live_input.hpp"

#include <poll.h>

#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

std::vector<LogReader::Warning> LiveInput::warnings() const {
  if (half_lines_ == 0) return {};
  return {{"half line of a sender that went away", half_lines_, name()}};
}

bool LiveInput::is_over() const { return is_closed_ || interrupted(); }

bool LiveInput::wait_for(int descriptor) {
  constexpr int kSlice_ms = 100;
  pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&waited, 1, kSlice_ms) > 0;
}

}  // namespace gdtslam
