// Search for the places of a cloud in another one, without a start. The walls of both, seen from above, are matched at
// every place and heading of the plane with the proof of find_pose(). Both clouds stand upright to a few degrees.
// Frames: those of the clouds, metres. The same on every machine. Cost: some tenths of a second for a building floor.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A place that the walls of both clouds allow.
struct WallPlace {
  Pose2 T_a_b;
  double mean_m = 0.0;     ///< mean distance of b's walls from a's, the distance limited
  bool is_proven = false;  ///< no pose outside the places before it fits better by more than the gap
};

/// At most `most` places, best first, each at least a metre or 20 degrees from those before; none if a cloud has no
/// walls. A device bounds the first boxes. Throws DeviceError.
std::vector<WallPlace> find_by_walls(std::span<const CloudPoint> a, std::span<const CloudPoint> b, std::size_t most,
                                     Backend& backend);

}  // namespace gdtslam
