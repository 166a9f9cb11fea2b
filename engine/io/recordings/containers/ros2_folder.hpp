// A ROS 2 bag on the disk: a folder with the files (SQLite or MCAP) that its metadata.yaml names in order, a folder
// with one such file, or a single file. Packed files (.db3.zstd, .mcap.zstd, .gz) are unpacked; SQLite into a temporary
// file, because it cannot be read forwards. One bag belongs to one thread.
#pragma once

#include <memory>
#include <string>

#include "recording.hpp"

namespace gdtslam {

/// Opens a file, packed or not, by its content. Throws RecordingFault, InputError or FileError.
std::unique_ptr<Recording> open_ros2_file(const std::string& path);

/// Opens the folder as one recording. Its first next() throws InputError for a folder without files, or with several in
/// unknown order; FileError. Files of metadata.yaml that are missing cause a warning.
std::unique_ptr<Recording> open_ros2_folder(const std::string& folder);

}  // namespace gdtslam
