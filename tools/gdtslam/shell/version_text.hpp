// What `gdtslam --version` says: the version, alone on the first line, the commit and what this build can do.
#pragma once

#include <string>

#include "commands.hpp"

namespace gdtslam {

std::string version_text(const BuildStamp& build);

}  // namespace gdtslam
