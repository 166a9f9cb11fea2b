// Names of files, and files that another file names: a map's image, a scene's meshes and linkage. A file from a
// stranger may refer only to files beside or below it. Thread-safe.
#pragma once

#include <string>

namespace gdtslam {

/// Reason not to open `name`, which the file `referrer` names: it leads out of the folder of `referrer`, also by a
/// symbolic link, is no regular file (a pipe would block), or cannot be shown in a message. Empty if it may be opened
/// or does not exist.
std::string fault_of_reference(const std::string& referrer, const std::string& name);

/// The ending of a file's name, ".png", in small letters.
std::string extension_of(const std::string& path);

/// The path of a file that another one names. Names are relative to the folder of `referrer`; only the last part of an
/// absolute one counts, since files are moved together.
std::string referenced_path(const std::string& referrer, const std::string& name);

}  // namespace gdtslam
