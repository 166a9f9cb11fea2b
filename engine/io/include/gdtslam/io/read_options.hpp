// How a log is read. The defaults suit every log whose lines follow docs/formats.md.
#pragma once

#include <optional>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

struct ReadOptions {
  bool lenient = false;                       ///< count and skip malformed lines instead of throwing
  std::optional<double> first_bearing_rad{};  ///< of beam 0; by the number of beams or by the line when empty
  std::optional<double> bearing_step_rad{};   ///< between beams; likewise
  std::optional<double> max_range_m{};        ///< the sensor's limit; what the log says when empty
  std::optional<Pose2> T_base_laser{};        ///< the mount; from the two poses of each scan line when empty
};

}  // namespace gdtslam
