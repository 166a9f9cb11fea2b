// A folder that takes its name as a whole. It is written beside its place, as `.NAME.gdtslam-new`, synced, and
// exchanged for the folder of that name, which is removed then. A process that fails or is killed before the exchange
// leaves the old folder as it was. Linux. One object belongs to one thread.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/transaction/folder_lock.hpp"

namespace gdtslam {

/// Whether a name is that of a folder that is being written. A killed process leaves one; the next writer removes it.
bool is_staging_name(std::string_view name);

class FolderTransaction {
 public:
  /// Makes the staging folder, and the folders above it, so that a place that cannot be written shows before the work
  /// is done. A link to a folder stays: its target is replaced. `before_removal` gets what a killed process left.
  /// Throws UsageError where another process writes there, or the place cannot be exchanged; FileError.
  explicit FolderTransaction(const std::string& path,
                             const std::function<void(const std::filesystem::path&)>& before_removal = {});
  FolderTransaction(const FolderTransaction&) = delete;
  FolderTransaction& operator=(const FolderTransaction&) = delete;
  /// Removes what is staged, and the folders that the object made and that are empty.
  ~FolderTransaction();

  [[nodiscard]] const std::filesystem::path& staging() const { return staging_; }
  /// The place, without links.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The last call. Throws FileError; UsageError where the old folder is locked.
  void commit();

 private:
  void lock_staging(const std::function<void(const std::filesystem::path&)>& before_removal);
  void exchange() const;

  std::string path_;  ///< as it was given, for messages
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_;  ///< folders above the target, the innermost first
  std::optional<FolderLock> lock_;
};

}  // namespace gdtslam
