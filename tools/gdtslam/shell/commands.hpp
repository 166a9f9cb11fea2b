// The command `gdtslam`: its sub-commands, its help and how errors become exit codes. Each sub-command adds its options
// to the command line; when it was chosen, the parser leaves in the context what to run. The functions only register:
// nothing is read or written while the command line is parsed.
#pragma once

#include <functional>
#include <span>

#include "cli.hpp"

namespace gdtslam {

/// What the command line asked for.
struct CommandContext {
  std::function<int()> run;  ///< the chosen sub-command; returns the exit code
  const char* when_out_of_memory = "it needs less data at a time or more memory";  ///< what to do then
};

/// Of the commands that make maps.
inline constexpr const char* kSmallerMap =
    "a smaller map.max_megacells or cloud.max_megavoxels, or a larger map.resolution needs less";

/// A sub-command of this build, or of another: tools/CMakeLists.txt lists them.
struct CommandRow {
  const char* name;
  void (*add)(CLI::App& app, CommandContext& context);  ///< null: not in this program
  const char* missing_option;  ///< the CMake option that is off then; null: the command is a module (modules.hpp)
};
/// In the order of the help.
std::span<const CommandRow> command_table();

/// Parses the command line and runs which of the sub-commands it asks for. Every error is one line on standard error;
/// returns the exit code (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv, std::span<const CommandRow> commands) noexcept;

}  // namespace gdtslam
