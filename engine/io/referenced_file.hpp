// Names of files, and files that another file names: a map's image, a scene's meshes and linkage. A file from a
// stranger may have none opened but those beside it. Thread-safe.
#pragma once

#include <string>

namespace gdtslam {

/// Why `name`, which stands in the file `referrer`, must not be opened: it leads out of the folder of `referrer`, also
/// by a symbolic link, is no regular file (a pipe would block), or no text to show in a message. Empty when it may be,
/// or when nothing is there.
std::string fault_of_reference(const std::string& referrer, const std::string& name);

/// The ending of a file's name, ".png", in small letters.
std::string extension_of(const std::string& path);

/// The path of a file that another one names. Names are relative to the folder of `referrer`; of an absolute one the
/// last part counts, since files are moved together.
std::string referenced_path(const std::string& referrer, const std::string& name);

}  // namespace gdtslam
