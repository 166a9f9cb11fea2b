// The system's text of an error number, independent of the locale's thread-unsafe strerror.
#pragma once

#include <string>
#include <system_error>

namespace gdtslam {

inline std::string errno_text(int code) { return std::generic_category().message(code); }

}  // namespace gdtslam
