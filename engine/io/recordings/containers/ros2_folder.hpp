// A ROS 2 bag as it lies on the disk: a folder with the files (SQLite or MCAP) that its metadata.yaml names, one after
// the other, a folder with one such file, or a file by itself. What was packed as a whole (.db3.zstd, .mcap.zstd, .gz)
// is unpacked; SQLite into a temporary file because it cannot be read forwards. One bag belongs to one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recording.hpp"

namespace gdtslam {

/// The files of a folder in their order. `warn` gets files that metadata.yaml names and that are not there. Throws
/// InputError for a folder without files, or with several in no known order; FileError.
std::vector<std::string> files_of_ros2_folder(const std::string& folder, const Recording::Warn& warn);

/// The file with that content, packed or not. Throws RecordingFault, InputError or FileError.
std::unique_ptr<Recording> open_ros2_file(const std::string& path);

/// The folder as one recording.
std::unique_ptr<Recording> open_ros2_folder(const std::string& folder);

}  // namespace gdtslam
