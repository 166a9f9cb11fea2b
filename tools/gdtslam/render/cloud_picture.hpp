// The picture of its cloud that `gdtslam map` leaves beside it. Not thread-safe: one OpenGL context at a time.
#pragma once

#include <string>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// The iso view, 1600 by 900 pixels, as the bytes of a PNG file. `linkage` may be null: the laser has none. Throws
/// UnavailableError where nothing can draw, InputError, FileError.
std::string draw_run_cloud(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                           const calib::SweepModel* linkage);

}  // namespace gdtslam
