// Drives through a rectangular room, maps it, and compares the last pose with where it really is. Exit status 0 when it
// agrees within 2 cm; nothing of gdtslam's own build is known here but its public headers.
#include <cmath>
#include <iostream>
#include <memory>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace {

// Corners of the room in the map, whose origin is the first pose; none on the border between two cells, where a wall
// without noise could fall to either side.
constexpr double kLeft_m = -2.023, kRight_m = 5.518, kBottom_m = -1.711, kTop_m = 3.132;

/// Range from the pose to the walls along a bearing.
double range_to_walls_m(const gdtslam::Pose2& pose, double bearing_rad) {
  const double dx = std::cos(pose.theta_rad + bearing_rad);
  const double dy = std::sin(pose.theta_rad + bearing_rad);
  const double along_x = ((dx > 0 ? kRight_m : kLeft_m) - pose.x_m) / dx;
  const double along_y = ((dy > 0 ? kTop_m : kBottom_m) - pose.y_m) / dy;
  return std::fmin(dx == 0 ? INFINITY : along_x, dy == 0 ? INFINITY : along_y);
}

gdtslam::LaserScan scan_from(const gdtslam::Pose2& pose, double stamp_s) {
  gdtslam::LaserScan scan;
  scan.stamp_s = stamp_s;
  scan.first_bearing_rad = gdtslam::rad_from_deg(-120.0);
  scan.bearing_step_rad = gdtslam::rad_from_deg(1.0);
  scan.max_range_m = 20.0;
  for (int k = 0; k <= 240; ++k) {
    const double bearing_rad = scan.first_bearing_rad + k * scan.bearing_step_rad;
    scan.ranges_m.push_back(static_cast<float>(range_to_walls_m(pose, bearing_rad)));
  }
  return scan;
}

}  // namespace

int main() {
  const std::unique_ptr<gdtslam::Backend> backend = gdtslam::make_cpu_backend({});
  gdtslam::Mapper mapper({}, *backend);
  gdtslam::Pose2 truth;
  gdtslam::Pose2 odometry;
  gdtslam::MatchResult match;
  for (int k = 0; k < 60; ++k) {
    match = mapper.process(scan_from(truth, 0.1 * k), odometry);
    truth = truth * gdtslam::Pose2{0.05, 0.0, 0.01};
    odometry = odometry * gdtslam::Pose2{0.055, 0.0, 0.012};  // 10 % and 20 % too much
  }
  truth = truth * gdtslam::inverse(gdtslam::Pose2{0.05, 0.0, 0.01});
  const gdtslam::Pose2 error = gdtslam::between(truth, match.T_map_base);
  const double error_m = error.translation().norm();
  std::cout << "error " << error_m << " m, " << gdtslam::deg_from_rad(error.theta_rad) << " deg, "
            << mapper.statistics().keyframes << " keyframes on " << backend->device().name << "\n";
  return error_m < 0.02 && mapper.statistics().keyframes > 3 ? 0 : 1;
}
