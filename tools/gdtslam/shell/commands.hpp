// The command `gdtslam`, and `gdtslam-lab`: sub-commands, help and how errors become exit codes. Each sub-command adds
// its options to the command line; when it was chosen, the parser leaves in the context what to run. The functions only
// register: nothing is read or written while the command line is parsed.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "cli.hpp"

namespace gdtslam {

/// The source that the program was built from. It is no part of any result: those depend on the version alone.
struct BuildStamp {
  std::string_view commit;  ///< from git, or named by the packager; "unknown" elsewhere
  std::string_view date;    ///< date of that commit, YYYY-MM-DD; empty if it is not known
};

/// The request of the command line.
struct CommandContext {
  std::function<int()> run;  ///< the chosen sub-command; returns the exit code
  const char* when_out_of_memory = "it needs less data at a time or more memory";  ///< advice to the user
  BuildStamp build{};
};

/// Advice of the commands that make maps.
inline constexpr const char* kSmallerMap =
    "a smaller map.max_megacells or cloud.max_megavoxels, or a larger map.resolution needs less";

/// A sub-command of this build, or of another.
struct CommandRow {
  const char* name;
  const char* group;                                    ///< its heading in the help
  void (*add)(CLI::App& app, CommandContext& context);  ///< null: not in this program
  const char* missing_option = nullptr;                 ///< the CMake option that is off then
};
/// A program of these commands.
struct Program {
  const char* name;
  const char* description;
  const char* examples;                  ///< below its help
  std::span<const CommandRow> commands;  ///< in the order of the help
};

/// The stamp of the program, which alone is made anew when the commit changes (cmake/GdtslamStamp.cmake).
BuildStamp build_stamp();

/// Parses the command line and runs which of the sub-commands it asks for. Every error is one line on standard error;
/// returns the exit code (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv, const Program& program, const BuildStamp& build) noexcept;

}  // namespace gdtslam
