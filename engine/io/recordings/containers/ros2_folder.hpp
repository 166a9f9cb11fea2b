// A ROS 2 bag as it lies on the disk: a folder with one or more files (SQLite or MCAP), with or without metadata.yaml,
// or one SQLite file of it. Files follow each other as metadata.yaml has them, else by their names, numbers in them as
// numbers. What was packed as a whole (.db3.zstd, .mcap.zstd, .gz) is unpacked; SQLite into a temporary file
// because it cannot be read forwards. One bag belongs to one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recording.hpp"

namespace gdtslam {

/// The files of a folder in their order. Throws InputError where it holds none, FileError where it cannot be read;
/// what is wrong with metadata.yaml is told by `warn`.
std::vector<std::string> files_of_ros2_folder(const std::string& folder, const Recording::Warn& warn);

/// The file with that content, packed or not. Throws RecordingFault, InputError or FileError.
std::unique_ptr<Recording> open_ros2_file(const std::string& path);

/// The folder as one recording.
std::unique_ptr<Recording> open_ros2_folder(const std::string& folder);

}  // namespace gdtslam
