// Search for other programs that a command runs. Thread-safe while nobody changes the environment.
#pragma once

#include <string>

namespace gdtslam {

/// Path of an executable in the absolute folders of PATH; empty if none has it. Empty and relative entries of PATH are
/// ignored, because they could run a file from a folder that somebody else filled.
std::string program_of_path(const std::string& name);

}  // namespace gdtslam
