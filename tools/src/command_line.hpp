// The command `gdtslam`: its sub-commands, its help and how errors become exit codes.
#pragma once

namespace gdtslam {

/// Parses the command line and runs what it asks for. Every error is one line on standard error; returns the exit code
/// (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv) noexcept;

}  // namespace gdtslam
