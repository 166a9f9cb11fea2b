// Commands that need large libraries (VTK, Ceres) are modules: shared objects of the folder lib/gdtslam beside
// the command's bin/, opened when the command line asks for one of them, so that the other commands start without those
// libraries. A module uses the functions that the program has and brings those that only it needs. One is opened once
// and stays; opening takes some 10 ms. Not thread-safe.
#pragma once

#include <string>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/stream.hpp"
#include "tools/gdtslam/shell/commands.hpp"

namespace gdtslam {

/// What a module gives to the program, under the name `gdtslam_module`.
struct Module {
  const char* version;  ///< of gdtslam; only the program's own fits
  void (*add)(CLI::App& app, CommandContext& context);
  /// Of `render`, for `map` (render/cloud_picture.hpp); null in the others.
  std::string (*draw_run_cloud)(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                                const calib::SweepModel* linkage);
};

/// The module of that command. Throws UnavailableError, one line with what is missing: the module itself, or a library
/// that it needs.
const Module& open_module(const std::string& command);

/// Where the module of that command is looked for, an absolute path.
std::string module_file(const std::string& command);

}  // namespace gdtslam
