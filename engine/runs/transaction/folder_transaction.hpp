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

/// The name under which the folder of that name is written. A killed process leaves it; the next writer removes it.
std::string staging_name(std::string_view name);
/// The folder that is written there.
std::filesystem::path target_of(const std::filesystem::path& staging);

class FolderTransaction {
 public:
  /// Gets a folder before it is removed: what a killed process left, and the old folder once its name is that of the
  /// new one. If it throws, the old folder has its name again.
  using BeforeRemoval = std::function<void(const std::filesystem::path& removed, bool is_old)>;
  /// Makes the staging folder, and the folders above it, so that a place that cannot be written shows before the work
  /// is done. A link to a folder stays: its target is replaced. Throws UsageError where another process writes there,
  /// or the place cannot be exchanged; FileError.
  explicit FolderTransaction(const std::string& path, BeforeRemoval before_removal = {});
  FolderTransaction(const FolderTransaction&) = delete;
  FolderTransaction& operator=(const FolderTransaction&) = delete;
  /// Removes what is staged, and the folders that the object made and that are empty.
  ~FolderTransaction();

  [[nodiscard]] const std::filesystem::path& staging() const { return staging_; }
  /// The place, without links.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The last call. Throws FileError; UsageError where the old folder is locked.
  void commit();
  /// The staged files stay where they are.
  void leave() { lock_.reset(); }

 private:
  void lock_staging();
  void exchange() const;

  std::string path_;  ///< as it was given, for messages
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> made_;  ///< folders above the target, the innermost first
  std::optional<FolderLock> lock_;
  BeforeRemoval before_removal_;
};

}  // namespace gdtslam
