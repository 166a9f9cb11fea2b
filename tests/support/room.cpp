#include "room.hpp"

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::test {
namespace {

constexpr double kNoReturn = 81.9;

void add_box(std::vector<Segment>& walls, double x0, double y0, double x1, double y1) {
  walls.push_back({{x0, y0}, {x1, y0}});
  walls.push_back({{x1, y0}, {x1, y1}});
  walls.push_back({{x1, y1}, {x0, y1}});
  walls.push_back({{x0, y1}, {x0, y0}});
}

double distance_along(const Point2& origin, double bearing_rad, const Segment& wall) {
  const long double dx = std::cos(static_cast<long double>(bearing_rad));
  const long double dy = std::sin(static_cast<long double>(bearing_rad));
  const long double ex = wall.to.x() - wall.from.x();
  const long double ey = wall.to.y() - wall.from.y();
  const long double determinant = dy * ex - dx * ey;
  if (std::fabs(determinant) < 1e-15L) return kNoReturn;
  const long double wx = wall.from.x() - origin.x();
  const long double wy = wall.from.y() - origin.y();
  const long double range = (wy * ex - wx * ey) / determinant;
  const long double along = (dx * wy - dy * wx) / determinant;
  return range > 0 && along >= 0 && along <= 1 ? static_cast<double>(range) : kNoReturn;
}

}  // namespace

std::vector<Segment> furnished_room() {
  std::vector<Segment> walls;
  add_box(walls, -2.0, -3.0, 6.0, 3.0);
  add_box(walls, 1.5, 1.0, 1.9, 1.6);
  add_box(walls, 4.6, -3.0, 6.0, -2.2);
  add_box(walls, -2.0, 2.4, -0.9, 3.0);
  walls.push_back({{3.2, 3.0}, {3.2, 1.4}});
  walls.push_back({{0.4, -3.0}, {0.4, -1.9}});
  // Turned, so that no wall runs along the cells: a wall on a cell's edge is half a cell off wherever it is seen from.
  const Pose2 turned{0.013, 0.017, 0.3};
  for (Segment& wall : walls) wall = {turned * wall.from, turned * wall.to};
  return walls;
}

LaserScan scan_of(const std::vector<Segment>& walls, const Pose2& T_map_base, double stamp_s, int beams) {
  LaserScan scan;
  scan.stamp_s = stamp_s;
  scan.first_bearing_rad = -kPi / 2;
  scan.bearing_step_rad = kPi / beams;
  for (int k = 0; k < beams; ++k) {
    const double bearing = T_map_base.theta_rad + scan.first_bearing_rad + k * scan.bearing_step_rad;
    double nearest = kNoReturn;
    for (const Segment& wall : walls) {
      nearest = std::min(nearest, distance_along(T_map_base.translation(), bearing, wall));
    }
    scan.ranges_m.push_back(static_cast<float>(nearest));
  }
  return scan;
}

std::vector<Pose2> drive_through_room() {
  std::vector<Pose2> poses;
  Pose2 pose;
  const auto move = [&](int steps, double forward_m, double turn_rad) {
    for (int i = 0; i < steps; ++i) {
      pose = pose * exp_se2({forward_m, 0.0, turn_rad});
      poses.push_back(pose);
    }
  };
  poses.push_back(pose);
  move(30, 0.07, 0.0);
  move(20, 0.05, -0.08);
  move(20, 0.06, 0.0);
  move(40, 0.0, 0.07);
  move(25, 0.07, 0.02);
  move(30, 0.06, 0.04);
  return poses;
}

}  // namespace gdtslam::test
