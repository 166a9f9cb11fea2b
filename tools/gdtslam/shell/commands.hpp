// The programs `gdtslam` and `gdtslam-lab`: sub-commands, help, and exit codes of errors. Each sub-command adds its
// options to the command line; the parser stores the chosen one in the context. The functions only register: nothing is
// read or written during parsing.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "cli.hpp"

namespace gdtslam {

/// The commit that the program was built from. Results do not depend on it, only on the version.
struct BuildStamp {
  std::string_view commit;  ///< from git, or set by the packager; else "unknown"
  std::string_view date;    ///< date of that commit, YYYY-MM-DD; empty if unknown
};

/// The parsed command line.
struct CommandContext {
  std::function<int()> run;  ///< the chosen sub-command; returns the exit code
  const char* when_out_of_memory = "it needs less data at a time or more memory";  ///< advice to the user
  BuildStamp build{};
};

/// Advice of the commands that make maps.
inline constexpr const char* kSmallerMap =
    "a smaller map.max_megacells or cloud.max_megavoxels, or a larger map.resolution needs less";

/// A sub-command, in this build or missing from it.
struct CommandRow {
  const char* name;
  const char* group;                                    ///< heading in the help
  void (*add)(CLI::App& app, CommandContext& context);  ///< null: not in this program
  const char* missing_option = nullptr;                 ///< the CMake option that is off if it is missing
};
/// A program with these commands.
struct Program {
  const char* name;
  const char* description;
  const char* examples;                  ///< below its help
  std::span<const CommandRow> commands;  ///< in the order of the help
};

/// The program's stamp. Only its source is rebuilt when the commit changes (cmake/GdtslamStamp.cmake).
BuildStamp build_stamp();

/// Parses the command line and runs the chosen sub-command. Every error is one line on standard error; returns the exit
/// code (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv, const Program& program, const BuildStamp& build) noexcept;

}  // namespace gdtslam
