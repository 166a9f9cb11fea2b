// A folder with all that is in it, removed although a signal interrupts that: on a network's file system a folder that
// is opened to be listed may be interrupted, as in retried.hpp. Thread-safe.
#pragma once

#include <filesystem>
#include <system_error>

namespace gdtslam {

/// Nothing where there is none. `failed` tells of what cannot be removed; what can be may be gone then.
inline void remove_tree(const std::filesystem::path& path, std::error_code& failed) {
  do {
    std::filesystem::remove_all(path, failed);
  } while (failed == std::errc::interrupted);
}

}  // namespace gdtslam
