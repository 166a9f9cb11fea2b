// Keeps a second writer out of a folder while the first lives: the kernel holds the lock (flock) for the process and
// takes it away with it, however that ends, and nothing lies in the folder for it. Where the file system knows no such
// lock, or several machines share it (NFS), writers on other machines are not kept out. One object belongs to one
// thread.
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
  /// If another process has it, throws UsageError or waits. Throws FileError. `shown` stands in messages, if not
  /// empty.
  explicit FolderLock(const std::filesystem::path& folder, Taken taken = Taken::kRefuse, const std::string& shown = {});
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// False where the file system knows no such lock, or does not let the folder be read: there may be other writers.
  [[nodiscard]] bool is_held() const { return is_held_; }
  /// Whether that is still the name of the folder.
  [[nodiscard]] bool is_on(const std::filesystem::path& folder) const;

 private:
  int descriptor_;
  bool is_held_ = false;
};

// A folder that takes its name as a whole. It is written beside its place, as `.NAME.gdtslam-new`, synced, and
// exchanged for the folder of that name, which is removed then. A process that fails or is killed before the exchange
// leaves the old folder as it was. Linux. One object belongs to one thread.

/// The name under which the folder of that name is written. A killed process leaves it; the next writer removes it.
std::string staging_name(std::string_view name);

class FolderTransaction {
 public:
  /// Gets the staging folder that a killed process left, before it is emptied.
  using BeforeRemoval = std::function<void(const std::filesystem::path& left)>;
  /// Makes the staging folder, and the folders above it, so that a place that cannot be written shows before the work
  /// is done. A link to a folder stays: its target is replaced. Throws UsageError if another process writes there or
  /// the place cannot be exchanged; FileError.
  explicit FolderTransaction(const std::string& path, const BeforeRemoval& before_removal = {});
  FolderTransaction(const FolderTransaction&) = delete;
  FolderTransaction& operator=(const FolderTransaction&) = delete;
  /// Removes what is staged, and the folders that the object made and that are empty.
  ~FolderTransaction();

  [[nodiscard]] const std::filesystem::path& staging() const { return staging_; }
  /// The place, without links.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The last call. Throws FileError; UsageError if the old folder is locked.
  void commit();

 private:
  void lock_staging();
  void exchange() const;

  std::string path_;  ///< path that was given, for messages
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_;  ///< folders above the target, the innermost first
  std::optional<FolderLock> lock_;
};

}  // namespace gdtslam
