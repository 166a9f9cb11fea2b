// Folders that `gdtslam reproduce` makes beside what its user has, and removes again. Each carries a mark, and nothing
// without the mark is removed, save empty folders. Thread-safe for different folders.
#pragma once

#include <string>

namespace gdtslam::reproduce {

/// True for a folder with the mark.
bool is_marked_folder(const std::string& path);
/// Throws FileError where something has this name that reproduce has not made.
void require_own_folder(const std::string& path);
/// Makes an empty folder with the mark; what had its name goes. Throws FileError, as the others do.
void make_marked_folder(const std::string& path);
/// The folder goes with all that is in it.
void remove_own_folder(const std::string& path);
/// The folder takes the name `to`, and what had that name goes afterwards: at each moment one of both has the name.
void replace_own_folder(const std::string& from, const std::string& to);

}  // namespace gdtslam::reproduce
