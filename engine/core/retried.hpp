// A system call once more where a signal interrupted it: the handlers of the command do not restart calls, so that
// reading a pipe ends, and on a network's file system open and fsync may be interrupted too. Whoever wants to end looks
// at the flag.
#pragma once

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

namespace gdtslam {

/// What the call returns, below 0 with errno where it failed of anything else than a signal.
template <typename Call>
auto retried(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// What lies in a folder, in no order. `failed` tells why it cannot be listed; what is returned then is not all.
inline std::vector<std::filesystem::directory_entry> list_folder(const std::filesystem::path& folder,
                                                                 std::error_code& failed) {
  std::vector<std::filesystem::directory_entry> entries;
  do {
    entries.clear();
    std::filesystem::directory_iterator entry(folder, failed);
    for (; !failed && entry != end(entry); entry.increment(failed)) entries.push_back(*entry);
  } while (failed == std::errc::interrupted);
  return entries;
}

/// A folder with all that is in it, which is opened to be listed. Nothing where there is none. `failed` tells of what
/// cannot be removed; what can be may be gone then.
inline void remove_tree(const std::filesystem::path& path, std::error_code& failed) {
  do {
    std::filesystem::remove_all(path, failed);
  } while (failed == std::errc::interrupted);
}

}  // namespace gdtslam
