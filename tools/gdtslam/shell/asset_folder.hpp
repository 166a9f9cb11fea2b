// Where the files that come with the command are: scenes, the sample log, the results that it must give.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// The folders of that kind ("scenes", "logs", "expected") that exist, best first: beside an installed command
/// (share/gdtslam), else in the source tree that it was built in.
std::vector<std::string> asset_folders(std::string_view kind);

/// A file in one of them. Throws FileError that names the folders.
std::string asset_file(std::string_view kind, const std::string& name);

/// The sample log that comes with the command. Throws FileError.
std::string sample_log_file();

}  // namespace gdtslam
