// Other programs that a command runs: where they are found. Thread-safe while nobody changes the environment.
#pragma once

#include <string>

namespace gdtslam {

/// The path of a program that can be run, of the absolute folders of PATH; empty where none of them has it. An entry of
/// PATH that is empty or relative does not count: it would run whatever lies in a folder that somebody else filled.
std::string program_of_path(const std::string& name);

}  // namespace gdtslam
