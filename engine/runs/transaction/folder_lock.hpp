// Keeps a second writer out of a folder while the first lives: the kernel holds the lock (flock) for the process and
// takes it away with it, however that ends, and nothing lies in the folder for it. Where the file system knows no such
// lock, or several machines share it (NFS), writers on other machines are not kept out. One object belongs to one
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gdtslam {

class FolderLock {
 public:
  enum class Taken : std::uint8_t { kRefuse, kWait };
  /// Where somebody else has it, throws UsageError or waits. Throws FileError. `shown` stands in messages, if not
  /// empty.
  explicit FolderLock(const std::filesystem::path& folder, Taken taken = Taken::kRefuse, const std::string& shown = {});
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// False where the file system knows no such lock, or does not let the folder be read: there may be other writers.
  [[nodiscard]] bool is_held() const { return is_held_; }
  /// Whether that is still the name of the folder.
  [[nodiscard]] bool is_of(const std::filesystem::path& folder) const;

 private:
  int descriptor_;
  bool is_held_ = false;
};

}  // namespace gdtslam
