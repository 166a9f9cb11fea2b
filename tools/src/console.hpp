// What a command prints. Results go to standard output and a write that fails is an error (exit 74), so that a full
// disk or a reader that went away does not pass for success; remarks go to standard error.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// Writes text to standard output as it is, and flushes. Throws FileError.
void print_result(std::string_view text);

/// Writes "gdtslam: <text>" and a line end to standard error.
void print_remark(std::string_view text);

}  // namespace gdtslam
