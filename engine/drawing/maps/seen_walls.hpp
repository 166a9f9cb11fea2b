// What of a map a laser would see from a pose: the walls that no other wall hides. Frame: that of the pose, metres.
// Thread-safe; O(beams * cells within reach).
#pragma once

#include <vector>

#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam::picture {

/// The middle of every occupied cell in which one of `beams` beams all around ends, each once, by row and column of the
/// map. Beams end where the map is unknown, too, without a wall.
std::vector<Point2> walls_seen_from(const OccupancyMap& map, const Pose2& T_map_pose, double reach_m, int beams);

}  // namespace gdtslam::picture
