// Repeats a system call that a signal interrupted. The handlers of the command do not restart calls, so that reading a
// pipe ends; on a network file system open and fsync may be interrupted too. Code that wants to end checks the flag.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <exception>
#include <string_view>

namespace gdtslam {

/// Returns the result of the call, below 0 with errno if it failed for another reason than a signal.
template <typename Call>
auto retried(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Writes the whole text, in several pieces if necessary; false with errno if it cannot be written.
inline bool write_whole(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = retried([&] { return ::write(descriptor, text.data(), text.size()); });
    if (count < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

/// For destructors and threads, which must not let exceptions out.
template <typename Call>
void without_throwing(const Call& call) noexcept {
  try {
    call();
  } catch (const std::exception&) {  // the next call reports a lasting fault
    return;
  }
}

}  // namespace gdtslam
