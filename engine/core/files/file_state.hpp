// The state of a file, which changes if the file is replaced, moved or written to. Linux.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace gdtslam {

struct FileState {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t written_ns = 0;
  std::int64_t changed_ns = 0;
  std::uint64_t bytes = 0;
  bool operator==(const FileState&) const = default;
};

/// The state of a file of that kind, S_IFREG or S_IFDIR, with links followed; none if there is no such file.
inline std::optional<FileState> state_of_file(const std::filesystem::path& path, mode_t kind = S_IFREG) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || (status.st_mode & S_IFMT) != kind) return std::nullopt;
  const auto nanoseconds = [](const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  };
  return FileState{.device = status.st_dev,
                   .inode = status.st_ino,
                   .written_ns = nanoseconds(status.st_mtim),
                   .changed_ns = nanoseconds(status.st_ctim),
                   .bytes = static_cast<std::uint64_t>(status.st_size)};
}

}  // namespace gdtslam
