// Folders for the time of a process, each with a mark that its process holds a lock on while it or a child of it lives.
// What a process that was killed left is removed by a later one: a folder whose mark has no owner that lives, or an
// empty one of such a name. What has no mark and is not empty stays. One object belongs to one thread.
#pragma once

#include <string>

namespace gdtslam {

class WorkFolder {
 public:
  /// Removes what is left of others below `parent`, which is made if need be, and makes a folder of its own there.
  /// Throws FileError.
  explicit WorkFolder(const std::string& parent);
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  /// The folder goes with all that is in it.
  ~WorkFolder();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  int mark_ = -1;
};

/// Removes what processes that were killed left below `parent`, as a WorkFolder does that is made there. What cannot be
/// listed or removed stays.
void remove_left_work(const std::string& parent);

/// Where work is done that other machines need not see: $SLURM_TMPDIR, $TMPDIR or /tmp.
std::string local_work_parent();

/// Moves the run folder to its place in the atlas: by its name where both are on one disk, else by a synced copy below
/// `staging`, which then takes the name. Where another process was first, its run stays, which has the same bytes.
/// Throws FileError.
void move_into_atlas(const std::string& run_folder, const std::string& atlas, const std::string& run,
                     const std::string& staging);

}  // namespace gdtslam
