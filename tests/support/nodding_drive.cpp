#include "nodding_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::test {
namespace {

struct Cuboid {
  Point3 low;
  Point3 high;
};
const Cuboid kRoom{{-3.0, -4.0, 0.0}, {5.0, 3.5, 2.6}};
const Cuboid kPillar{{2.0, 1.0, -1.0}, {2.6, 1.8, 4.0}};

// Along a ray: where it leaves the room, or enters the pillar before that (the slab method).
double cast(const Point3& origin, const Point3& direction) {
  const auto slabs = [&](const Cuboid& cuboid) {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (cuboid.low[axis] - origin[axis]) / direction[axis];
      const double b = (cuboid.high[axis] - origin[axis]) / direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return std::array{enter, leave};
  };
  const auto [pillar_enter, pillar_leave] = slabs(kPillar);
  const double wall = slabs(kRoom)[1];
  return pillar_enter < pillar_leave && pillar_enter > 0.0 ? std::min(pillar_enter, wall) : wall;
}

// Distance to the surface of a cuboid, seen from inside or outside.
double distance_to_cuboid_m(const Cuboid& cuboid, const Point3& point) {
  Point3 outside = Point3::Zero();
  double inside = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    outside[axis] = std::max({cuboid.low[axis] - point[axis], point[axis] - cuboid.high[axis], 0.0});
    inside = std::min({inside, point[axis] - cuboid.low[axis], cuboid.high[axis] - point[axis]});
  }
  return outside.norm() > 0.0 ? outside.norm() : inside;
}

double bearing_of(const NoddingDrive& drive, std::size_t beam) {
  const double step = rad_from_deg(240.0) / static_cast<double>(drive.beams - 1);
  return rad_from_deg(-120.0) + step * static_cast<double>(beam);
}

}  // namespace

NoddingScanner scanner_of(const NoddingDrive& drive) {
  return {.mount = drive.mount,
          .table = ElevationTable::identity(),
          .mirror_rate_hz = drive.mirror_rate_hz,
          .stamp_share = 0.5};
}

NoddingScan scan_of(const NoddingDrive& drive, std::size_t number) {
  constexpr std::size_t kKnots = 9;
  const double stamp_s = static_cast<double>(number) / drive.scan_rate_hz;
  NoddingScan scan;
  LaserScan& laser = scan.record.scan;
  laser.stamp_s = stamp_s;
  laser.first_bearing_rad = bearing_of(drive, 0);
  laser.bearing_step_rad = bearing_of(drive, 1) - bearing_of(drive, 0);
  laser.max_range_m = 20.0;
  const BeamTiming timing = scanner_of(drive).timing(drive.beams, laser.bearing_step_rad);
  for (std::size_t beam = 0; beam < drive.beams; ++beam) {
    const double time_s = stamp_s + timing.of_beam_s(beam);
    const Pose3 T = T_base_laser(drive.mount, laser.T_base_laser, drive.elevation_rad(time_s));
    const Pose3 T_room_laser = embed(drive.T_room_base(time_s)) * T;
    const double bearing = bearing_of(drive, beam);
    const Point3 direction = rotation_matrix(T_room_laser.rotation) * Point3(std::cos(bearing), std::sin(bearing), 0.0);
    laser.ranges_m.push_back(static_cast<float>(cast(T_room_laser.translation_m, direction)));
  }
  for (std::size_t k = 0; k < kKnots; ++k) {
    const double offset_s = timing.first_s + (timing.of_beam_s(drive.beams - 1) - timing.first_s) *
                                                 static_cast<double>(k) / static_cast<double>(kKnots - 1);
    scan.knots.push_back({offset_s, phase_of_elevation(drive.elevation_rad(stamp_s + offset_s))});
  }
  Pose2 T_odom_base = between(drive.T_room_base(0.0), drive.T_room_base(stamp_s));
  T_odom_base.x_m *= drive.odometry_scale;
  T_odom_base.y_m *= drive.odometry_scale;
  scan.record.T_odom_base = T_odom_base;
  return scan;
}

double distance_to_room_m(const Point3& point) {
  return std::min(distance_to_cuboid_m(kRoom, point), distance_to_cuboid_m(kPillar, point));
}

}  // namespace gdtslam::test
