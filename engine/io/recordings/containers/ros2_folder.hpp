// A ROS 2 bag as it lies on the disk: a folder with the files (SQLite or MCAP) that its metadata.yaml names, one after
// the other, a folder with one such file, or a file by itself. What was packed as a whole (.db3.zstd, .mcap.zstd, .gz)
// is unpacked; SQLite into a temporary file because it cannot be read forwards. One bag belongs to one thread.
#pragma once

#include <memory>
#include <string>

#include "recording.hpp"

namespace gdtslam {

/// The file with that content, packed or not. Throws RecordingFault, InputError or FileError.
std::unique_ptr<Recording> open_ros2_file(const std::string& path);

/// The folder as one recording, whose first call of next() throws InputError for a folder without files, or with
/// several in no known order; FileError. Files that metadata.yaml names and that are missing are a warning.
std::unique_ptr<Recording> open_ros2_folder(const std::string& folder);

}  // namespace gdtslam
