// A robot that stands in a corridor when its log begins, as at the start of the Intel log: its odometry says one pose
// again and again, as that of a log without odometry does, and nothing in the corridor tells where along it the robot
// is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

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
    LoopMapper mapper(MapperConfig{}, *cpu);
    for (int i = 0; i < kScans; ++i) {
      mapper.start(corridor_scan(0.2 * i, random), Pose2{0.0, 0.0, -0.002458});
      const MatchResult result = mapper.finish();
      ASSERT_LT(std::hypot(result.T_map_base.x_m, result.T_map_base.y_m), 0.05) << "scan " << i << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace gdtslam
