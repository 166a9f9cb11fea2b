#include "console.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

void print_result(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    if (errno == EPIPE) return;  // the reader had enough, as `head` has
    throw FileError("standard output", "cannot be written: " + std::generic_category().message(errno));
  }
}

void print_remark(std::string_view text) {
  fmt::print(stderr, "gdtslam: {}\n", text);
  std::fflush(stderr);
}

}  // namespace gdtslam
