// Two lasers back to back, one some milliseconds after the other, on a robot without odometry: how it moves while they
// sweep is known by the map alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/edits/source_run.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

constexpr int kBeams = 180;
constexpr double kBeamPeriod_s = 0.0005;
constexpr int kSweeps = 120;
constexpr double kSweepPeriod_s = 0.1;
constexpr double kSecondAfter_s = 0.005;
const std::array<Pose2, 2> kMounts{Pose2{0.3, 0.0, 0.0}, Pose2{-0.3, 0.0, kPi}};

// A metre ahead and back in seven seconds, half a metre a second at the most.
Pose2 true_pose(double at_s) { return {0.5 * (1.0 - std::cos(at_s)), 0.0, 0.0}; }
double true_speed(double at_s) { return 0.5 * std::sin(at_s); }

// All around, each beam from where the robot was then.
std::string row_of_sweep(double stamp_s, std::size_t laser, Random& random) {
  static const std::vector<test::Segment> walls = test::furnished_room();
  const Pose2& mount = kMounts[laser];
  std::string row = fmt::format("{:.6f},{},{},{},{}", stamp_s, laser, mount.x_m, mount.y_m, mount.theta_rad);
  row += fmt::format(",{},{},{},20", -kPi, kTwoPi / kBeams, kBeamPeriod_s);
  for (int k = 0; k < kBeams; ++k) {
    Pose2 T_map_beam = true_pose(stamp_s + k * kBeamPeriod_s) * mount;
    T_map_beam.theta_rad += kTwoPi * k / kBeams - kPi + kPi / 2.0;  // the only beam of a scan points to the right
    const auto range_m = static_cast<double>(test::scan_of(walls, T_map_beam, 0.0, 1).ranges_m.front());
    row += fmt::format(",{:.4f}", range_m + random.normal(0.0, 0.005));
  }
  return row + "\n";
}

void write_two_lasers(const std::string& file) {
  std::ofstream log(file);
  log << "stamp,laser,laser_x,laser_y,laser_theta,angle_min,angle_increment,time_increment,range_max";
  for (int k = 0; k < kBeams; ++k) log << ",r" << k;
  log << "\n";
  Random random(3);
  for (int k = 0; k < kSweeps; ++k) {
    const double stamp_s = kSweepPeriod_s * k;
    log << row_of_sweep(stamp_s, 0, random) << row_of_sweep(stamp_s + kSecondAfter_s, 1, random);
  }
}

TEST(TwoLasersWithoutOdometry, KeepThePathAndTheSpeedOfEach) {
  const test::RunsFolder folder("two-lasers");
  write_two_lasers(folder.path("two.csv"));
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapRequest request = test::ring_request(folder.path("two.csv"), folder.path("run"));
  request.with_loops = false;
  const Trajectory poses = map_logs(request, *cpu).outcome.trajectory;
  ASSERT_EQ(poses.size(), 2U * kSweeps);
  double worst_m = 0.0;
  for (const StampedPose& pose : poses) {
    worst_m = std::max(worst_m, between(true_pose(pose.stamp_s), pose.T_map_base).translation().norm());
  }
  EXPECT_LT(worst_m, 0.03);

  // Read once more for edits, the scans have the same speeds.
  std::size_t without = 0;
  double worst_m_per_s = 0.0;
  const auto take = [&](const LaserScan& scan, const Pose2& /*T*/, double /*share*/) {
    if (!scan.speed) {
      ++without;
    } else {
      const double before_s = scan.stamp_s - 1.5 * kSweepPeriod_s + 0.5 * kBeams * kBeamPeriod_s;
      worst_m_per_s = std::max(worst_m_per_s, std::fabs((*scan.speed)[0] - true_speed(before_s)));
    }
  };
  EXPECT_TRUE(for_each_cast_scan(read_source_run(folder.path("run")), take)) << "from its log";
  EXPECT_EQ(without, 4U) << "the first two scans of each";
  EXPECT_LT(worst_m_per_s, 0.5);
}

}  // namespace
}  // namespace gdtslam
