// What a command prints. Results go to standard output and a write that fails is an error (exit 74), so that a full
// disk or a reader that went away does not pass for success; remarks and errors go to standard error, a line each.
// Names of files, logs and options are anybody's: control characters and what is no UTF-8 are shown as \x1b and the
// like, so that no text can add a line to a message or give an order to a terminal.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// Writes text to standard output, line ends and tabs as they are, and flushes. Throws FileError.
void print_result(std::string_view text);

/// Writes "gdtslam: <text>" and a line end to standard error.
void print_remark(std::string_view text);

/// Writes "gdtslam: error: <text>" and a line end to standard error.
void print_error(std::string_view text);

/// The text without control characters, save those of `kept`, and in valid UTF-8.
std::string printable(std::string_view text, std::string_view kept = "");

}  // namespace gdtslam
