// A world that needs no simulator: walls as segments, a laser that meets them exactly. For tests of the mapper.
#pragma once

#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam::test {

/// A wall from one point to the other, metres, map frame.
struct Segment {
  Point2 from;
  Point2 to;
};

/// A room of 8 x 6 m with a pillar, a niche and a partition, so that no two poses look alike, turned by 0.3 rad.
std::vector<Segment> furnished_room();

/// A scan of 180 beams, one degree apart, from the pose; ranges from segment intersection in long double, no return
/// = 81.9.
LaserScan scan_of(const std::vector<Segment>& walls, const Pose2& T_map_base, double stamp_s, int beams = 180);

/// A drive through furnished_room(): poses about 7 cm or 4 degrees apart.
std::vector<Pose2> drive_through_room();

}  // namespace gdtslam::test
