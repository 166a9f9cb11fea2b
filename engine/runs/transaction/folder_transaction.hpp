// Keeps a second writer out of a folder while the first lives. The kernel holds the lock (flock) and releases it
// however the process ends; the folder needs no lock file. Without such locks in the file system, or with several
// machines sharing it (NFS), other writers are not kept out. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

class FolderLock {
 public:
  enum class Taken : std::uint8_t { kRefuse, kWait };
  /// If another process has it, throws UsageError or waits. Throws FileError. `shown` is for messages, if not empty.
  explicit FolderLock(const std::filesystem::path& folder, Taken taken = Taken::kRefuse, const std::string& shown = {});
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// False if the file system has no such lock, or the folder cannot be read: then there may be other writers.
  [[nodiscard]] bool is_held() const { return is_held_; }
  /// True if that is still the name of the locked folder.
  [[nodiscard]] bool is_on(const std::filesystem::path& folder) const;

 private:
  int descriptor_;
  bool is_held_ = false;
};

// Replaces a folder as a whole. The new one is written beside it as `.NAME.gdtslam-new`, synced, and exchanged for the
// old one, which is then removed. A process that fails or is killed before the exchange leaves the old folder as it
// was. Linux. One object belongs to one thread.

/// The name of the staging folder for a folder. A killed process leaves it; the next writer removes it.
std::string staging_name(std::string_view name);

class FolderTransaction {
 public:
  /// Called with the staging folder that a killed process left, before it is emptied.
  using BeforeRemoval = std::function<void(const std::filesystem::path& left)>;
  /// Makes the staging folder and the folders above it, so that a place that cannot be written is reported before the
  /// work. A link to a folder stays: its target is replaced. Throws UsageError if another process writes there or the
  /// place cannot be exchanged; FileError.
  explicit FolderTransaction(const std::string& path, const BeforeRemoval& before_removal = {});
  FolderTransaction(const FolderTransaction&) = delete;
  FolderTransaction& operator=(const FolderTransaction&) = delete;
  /// Removes staged files, and empty folders that the object made.
  ~FolderTransaction();

  [[nodiscard]] const std::filesystem::path& staging() const { return staging_; }
  /// The folder to replace, with links resolved.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The last call. Throws FileError; UsageError if the old folder is locked.
  void commit();

 private:
  void lock_staging();
  void exchange() const;

  std::string path_;  ///< the given path, for messages
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_;  ///< folders above the target, the innermost first
  std::optional<FolderLock> lock_;
};

}  // namespace gdtslam
