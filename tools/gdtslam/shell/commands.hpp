// The command `gdtslam`, and `gdtslam-lab`: sub-commands, help and how errors become exit codes. Each sub-command adds
// its options to the command line; when it was chosen, the parser leaves in the context what to run. The functions only
// register: nothing is read or written while the command line is parsed.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "cli.hpp"

namespace gdtslam {

/// What the program was built from. It is no part of any result: those depend on the version alone.
struct BuildStamp {
  std::string_view commit;  ///< of git, or as the packager named it; "unknown" elsewhere
  std::string_view date;    ///< of that commit, YYYY-MM-DD; empty where it is not known
};

/// What the command line asked for.
struct CommandContext {
  std::function<int()> run;  ///< the chosen sub-command; returns the exit code
  const char* when_out_of_memory = "it needs less data at a time or more memory";  ///< what to do then
  BuildStamp build{};
};

/// Of the commands that make maps.
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

/// Of the program, which alone is made anew when the commit changes (cmake/GdtslamStamp.cmake).
BuildStamp build_stamp();

/// Parses the command line and runs which of the sub-commands it asks for. Every error is one line on standard error;
/// returns the exit code (core/error.hpp). Never throws.
int run_command_line(int argc, char** argv, const Program& program, const BuildStamp& build) noexcept;

}  // namespace gdtslam
