// A robot that stands in a corridor when its log begins, as at the start of the Intel log: its odometry says one pose
// again and again, as that of a log without odometry does, and nothing in the corridor tells where along it the robot
// is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>

#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {
namespace {

constexpr int kScans = 140;
constexpr double kLongest_m = 81.83;

// Half a circle of 180 beams between walls at y = -1.1 m and 1.5 m, ranges to the centimetre.
LaserScan corridor_scan(double stamp_s, Random& random) {
  LaserScan scan;
  scan.stamp_s = stamp_s;
  scan.first_bearing_rad = -std::numbers::pi / 2.0;
  scan.bearing_step_rad = std::numbers::pi / 180.0;
  scan.max_range_m = kLongest_m;
  for (int k = 0; k < 180; ++k) {
    const double bearing_rad = scan.first_bearing_rad + scan.bearing_step_rad * k;
    const double to_side_m = std::sin(bearing_rad) < 0.0 ? 1.1 : 1.5;
    const double range_m = to_side_m / std::max(1e-9, std::fabs(std::sin(bearing_rad)));
    const double measured_m = std::round((range_m + 0.01 * random.normal()) * 100.0) / 100.0;
    scan.ranges_m.push_back(static_cast<float>(range_m > 30.0 ? kLongest_m : measured_m));
  }
  return scan;
}

TEST(StandingStart, DoesNotSlideAlongACorridor) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Random random(seed);
    Mapper mapper(MapperConfig{}, *cpu, {.with_loops = true});
    for (int i = 0; i < kScans; ++i) {
      const MatchResult result = mapper.process(corridor_scan(0.2 * i, random), Pose2{0.0, 0.0, -0.002458});
      ASSERT_LT(std::hypot(result.T_map_base.x_m, result.T_map_base.y_m), 0.05) << "scan " << i << ", seed " << seed;
    }
  }
}

// Two metres wide and closed at both ends, seen in a full circle; ranges to the centimetre.
LaserScan closed_corridor_scan(double stamp_s, double x_m, double half_length_m, Random& random) {
  constexpr int kBeams = 720;
  LaserScan scan;
  scan.stamp_s = stamp_s;
  scan.first_bearing_rad = -std::numbers::pi;
  scan.bearing_step_rad = 2.0 * std::numbers::pi / kBeams;
  scan.max_range_m = kLongest_m;
  for (int k = 0; k < kBeams; ++k) {
    const double bearing_rad = scan.first_bearing_rad + scan.bearing_step_rad * k;
    const double ahead = std::cos(bearing_rad);
    const double to_end_m = half_length_m + (ahead > 0.0 ? -x_m : x_m);
    const double range_m =
        std::min(1.0 / std::max(1e-9, std::fabs(std::sin(bearing_rad))), to_end_m / std::max(1e-9, std::fabs(ahead)));
    scan.ranges_m.push_back(static_cast<float>(std::round((range_m + 0.01 * random.normal()) * 100.0) / 100.0));
  }
  return scan;
}

// Without odometry: three and six beams of a hundred see the ends, which is no worse a fit for long.
TEST(StandingStart, HoldsNobodyWhoDrivesOffWhereTheEndsAreSeen) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  for (const double half_length_m : {10.0, 20.0}) {
    for (const double step_m : {0.02, 0.05, 0.1, 0.2}) {
      Random random(1);
      Mapper mapper(MapperConfig{}, *cpu, {.with_loops = true});
      const double first_m = -0.4 * half_length_m;
      for (int i = 0; i < 60; ++i) {
        const LaserScan scan = closed_corridor_scan(0.1 * i, first_m + step_m * i, half_length_m, random);
        ASSERT_NEAR(mapper.process(scan, std::nullopt).T_map_base.x_m, step_m * i, 0.05)
            << "scan " << i << ", " << step_m << " m a scan, " << half_length_m << " m";
      }
    }
  }
}

TEST(StandingStart, LetsGoWhoStoodAndDrivesOff) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  for (const double step_m : {0.02, 0.05, 0.1}) {
    Random random(2);
    Mapper mapper(MapperConfig{}, *cpu, {.with_loops = true});
    double last_m = 0.0;
    for (int i = 0; i < 140; ++i) {
      const double way_m = step_m * std::max(0, i - 80);
      const LaserScan scan = closed_corridor_scan(0.1 * i, way_m - 3.0, 10.0, random);
      last_m = mapper.process(scan, std::nullopt).T_map_base.x_m - way_m;
    }
    EXPECT_NEAR(last_m, 0.0, 0.05) << step_m;
  }
}

}  // namespace
}  // namespace gdtslam
