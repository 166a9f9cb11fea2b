// A nodding laser in a room that is known in closed form: a cuboid with a pillar. Frame: the room's, x and y along its
// walls, z = 0 the floor. The scans' elevations come as phases of ElevationTable::identity(), so no linkage has a part.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam::test {

struct NoddingDrive {
  std::function<Pose2(double)> T_room_base = [](double) { return Pose2{}; };
  std::function<double(double)> elevation_rad = [](double) { return 0.0; };
  double odometry_scale = 1.0;  ///< of the odometry's travel over the true one
  NoddingMount mount{.height_m = 0.5};
  double mirror_rate_hz = 0.0;
  double scan_rate_hz = 20.0;
  std::size_t beams = 241;
};

NoddingScanner scanner_of(const NoddingDrive& drive);
/// The scan with this number; its stamp is number / scan_rate. Each beam is cast from where the laser is at its time.
NoddingScan scan_of(const NoddingDrive& drive, std::size_t number);
/// Distance of a point of the room to the nearest of its surfaces.
double distance_to_room_m(const Point3& point);

}  // namespace gdtslam::test
