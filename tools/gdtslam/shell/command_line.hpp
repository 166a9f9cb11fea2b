// The command `gdtslam`: its help and how errors become exit codes.
#pragma once

#include <span>

#include "commands.hpp"

namespace gdtslam {

/// Parses the command line and runs which of the sub-commands it asks for. Every error is one line on standard error;
/// returns the exit code (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv, std::span<const CommandRow> commands) noexcept;

}  // namespace gdtslam
