// A system call once more where a signal interrupted it: the handlers of the command do not restart calls, so that
// reading a pipe ends, and on a network's file system open and fsync may be interrupted too. Whoever wants to end looks
// at the flag.
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

/// The whole text, in as many pieces as it takes; false with errno where it cannot be written.
inline bool write_whole(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = retried([&] { return ::write(descriptor, text.data(), text.size()); });
    if (count < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

/// For destructors and threads, which let no exception through.
template <typename Call>
void without_throwing(const Call& call) noexcept {
  try {
    call();
  } catch (const std::exception&) {  // the next call reports what lasts
    return;
  }
}

}  // namespace gdtslam
