// Files in a run's folder that no run wrote: masks for a planner (keepout.pgm), notes. They are the user's: an edit
// copies them as they are where the frame stays, and leaves them where it changes. Thread-safe.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_folder.hpp"

namespace gdtslam {

/// Names of files and folders in `run` that no run, merge or edit writes, by the alphabet. `with_map_picture`: map.png
/// and map.pgw are an edit's.
std::vector<std::string> other_files_in(const std::string& run, bool with_map_picture);

/// Stages copies of those of them that are plain files, no links to what lies outside the run, and whose name is not
/// taken in the folder, but for what an earlier edit copied there and nobody changed; returns the names of those.
/// `before_piece` is called before each MiB and may throw. Throws FileError.
std::vector<std::string> copy_other_files(const std::string& run, const std::vector<std::string>& names,
                                          RunFolder& folder, const std::function<void()>& before_piece);

}  // namespace gdtslam
