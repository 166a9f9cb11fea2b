// A file without a name for data that a process keeps on disk while it runs. It disappears with its object, however the
// process ends. Places in it are byte offsets from its beginning. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace gdtslam {

class ScratchFile {
 public:
  /// Makes the file in `folder`; if that is empty, in the folder of the variable TMPDIR or in /var/tmp. Throws
  /// FileError if the folder takes no file.
  explicit ScratchFile(const std::string& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /// Throws FileError if the disk is full.
  void write(std::uint64_t place, std::span<const std::byte> bytes);
  /// Reads the bytes written at this place. Throws FileError.
  void read(std::uint64_t place, std::span<std::byte> bytes) const;

 private:
  std::string folder_;
  int descriptor_ = -1;
};

}  // namespace gdtslam
