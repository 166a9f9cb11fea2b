// Which files are those of a run, by whatever path somebody names them: through links, through `..`, or before they are
// there. Whoever reads one must not replace it. Thread-safe; a few calls of the system each.
#pragma once

#include <filesystem>
#include <string>

namespace gdtslam {

/// The file's path with every link and `..` resolved; of what is not there yet, where it would be made.
std::filesystem::path place_of_file(const std::string& file);

/// Whether `file` lies in the folder, or in one inside it.
bool lies_in(const std::string& folder, const std::string& file);

/// Whether `file` is, or would be, one that a run of this program writes into `folder`.
bool is_run_file_in(const std::string& folder, const std::string& file);

}  // namespace gdtslam
