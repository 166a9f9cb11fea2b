// Poses between two fixes, equation (13). By time, never by index. Frame: map. Thread-safe, constant time.
#pragma once

#include <cstdint>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {

/// A fix with the odometry at its time.
struct PoseFix {
  double stamp_s = 0.0;
  Pose2 T_map_base;
  Pose2 T_odom_base;
};

/// share 0 gives `from`, 1 gives `to`; T_odom_base (of the moment asked for) is read by kOdometry only.
Pose2 interpolate(PoseInterpolation how, const PoseFix& from, const PoseFix& to, double share,
                  const Pose2& T_odom_base);

}  // namespace gdtslam
