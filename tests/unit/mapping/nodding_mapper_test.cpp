// The 3D system of figure 10 in a room that is known in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "support/nodding_drive.hpp"
#include "support/queued_backend.hpp"

namespace gdtslam {
namespace {

using test::NoddingDrive;

// Up and down between 0 and 80 deg once in `period_s`, resting at neither end.
double nod(double time_s, double period_s) {
  return rad_from_deg(40.0) * (1.0 - std::cos(2.0 * kPi * time_s / period_s));
}

struct NoddingOutcome {
  std::vector<NoddingPose> poses;
  Cloud cloud;
  NoddingStatistics statistics;
  std::vector<std::string> warnings;
  std::string device_warning;
};

struct Job {
  NoddingConfig config;
  std::size_t scans = 240;
  bool fall_back = true;
};

Job with(const std::function<void(NoddingConfig&)>& change) {
  Job job;
  change(job.config);
  return job;
}

NoddingOutcome map(const NoddingDrive& drive, const Job& job, Backend& backend,
                   const std::function<void(NoddingScan&, std::size_t)>& change = {}) {
  NoddingOutcome outcome;
  MapperOptions options{
      .fall_back = job.fall_back, .cpu = {}, .warn = [&](const std::string& text) { outcome.device_warning = text; }};
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  Mapper mapper(MapperConfig{}, *cpu);
  CloudKeeper cloud;
  NoddingMapper nodding(
      job.config, test::scanner_of(drive), mapper, backend, cloud,
      [&](const NoddingPose& pose, const NoddingScan&) { outcome.poses.push_back(pose); }, options);
  for (std::size_t k = 0; k < job.scans; ++k) {
    NoddingScan scan = test::scan_of(drive, k);
    if (change) change(scan, k);
    nodding.process(std::move(scan));
  }
  nodding.finish();
  outcome.cloud = std::move(cloud.cloud);
  outcome.statistics = nodding.statistics();
  outcome.warnings = nodding.warnings();
  return outcome;
}

NoddingOutcome map(const NoddingDrive& drive, const Job& job = {},
                   const std::function<void(NoddingScan&, std::size_t)>& change = {}) {
  return map(drive, job, *make_cpu_backend({}), change);
}

// The map's origin is the robot's pose at the first fix.
double largest_distance_m(const NoddingDrive& drive, const Cloud& cloud, double first_fix_s = 0.0) {
  const Pose3 T_room_map = embed(drive.T_room_base(first_fix_s));
  double largest = 0.0;
  for (const CloudPoint& p : cloud) {
    const Point3 point(static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m));
    largest = std::max(largest, test::distance_to_room_m(T_room_map * point));
  }
  return largest;
}

NoddingDrive standing() {
  NoddingDrive drive;
  drive.elevation_rad = [](double t) { return nod(t, 4.0); };
  drive.mount = {.height_m = 0.5, .lever_forward_m = 0.04, .lever_up_m = 0.03, .sensor_roll_rad = 0.01};
  drive.mirror_rate_hz = 20.0;
  return drive;
}

NoddingDrive driving() {
  NoddingDrive drive = standing();
  drive.T_room_base = [](double t) {
    return Pose2{-1.5 + 0.2 * t, -0.5 + 0.1 * std::sin(0.5 * t), 0.3 * std::sin(0.4 * t)};
  };
  return drive;
}

TEST(NoddingMapper, StandingRobotGivesTheRoomWithinTheRoundingOfItsRanges) {
  const NoddingOutcome outcome = map(standing());
  EXPECT_GT(outcome.cloud.size(), 40000U);
  EXPECT_LT(largest_distance_m(standing(), outcome.cloud), 0.0005);
  EXPECT_EQ(outcome.poses.size(), 240U);
  EXPECT_EQ(outcome.statistics.fixes + outcome.statistics.between + outcome.statistics.by_odometry, 240U);
  EXPECT_EQ(outcome.statistics.points, outcome.cloud.size());
}

// A robot that is carried: the odometry says nothing, and the poses still follow the walls.
TEST(NoddingMapper, OdometryThatNeverMovesIsNotTakenForStandingStill) {
  NoddingDrive drive = standing();
  drive.T_room_base = [](double t) { return Pose2{-1.0 + 0.05 * t, 0.0, 0.0}; };
  drive.odometry_scale = 0.0;
  const NoddingOutcome outcome = map(drive);
  const Pose2& last = outcome.poses[161].T_map_base;  // the fix after two periods
  EXPECT_NEAR(last.x_m, 0.4, 0.03);
}

// 12 s at 4 s a period: three lifts and three returns, the first scan level.
TEST(NoddingMapper, CountsStrokes) { EXPECT_EQ(map(standing()).statistics.sweeps, 6U); }

TEST(NoddingMapper, PosesAndPointsComeInLogOrder) {
  const NoddingOutcome outcome = map(driving());
  for (std::size_t k = 0; k < outcome.poses.size(); ++k) EXPECT_EQ(outcome.poses[k].scan, k);
  EXPECT_TRUE(std::is_sorted(outcome.cloud.begin(), outcome.cloud.end(),
                             [](const CloudPoint& a, const CloudPoint& b) { return a.scan < b.scan; }));
}

TEST(NoddingMapper, APointKnowsItsElevationItsTimeAndItsScan) {
  const NoddingDrive drive = driving();
  const NoddingOutcome outcome = map(drive);
  for (std::size_t k = 0; k < outcome.cloud.size(); k += 97) {
    const CloudPoint& point = outcome.cloud[k];
    EXPECT_NEAR(static_cast<double>(point.elevation_rad), drive.elevation_rad(point.stamp_s), 2e-4);
    EXPECT_NEAR(point.stamp_s, static_cast<double>(point.scan) / drive.scan_rate_hz, 0.5 / drive.mirror_rate_hz);
  }
}

// With odometry that is 5 % too long the wheels alone would be 10 cm off after one lift.
TEST(NoddingMapper, ADrivingRobotIsFixedByItsHorizontalScans) {
  for (const auto how : {PoseInterpolation::kGeodesic, PoseInterpolation::kOdometry, PoseInterpolation::kLinear}) {
    NoddingDrive drive = driving();
    drive.odometry_scale = 1.05;
    const NoddingOutcome outcome = map(drive, with([how](NoddingConfig& config) { config.interpolation = how; }));
    double sum_m = 0.0;
    for (const NoddingPose& pose : outcome.poses) {
      if (pose.stamp_s > 8.0) break;  // then there is no fix behind
      const Pose2 truth = between(drive.T_room_base(0.0), drive.T_room_base(pose.stamp_s));
      sum_m += (truth.translation() - pose.T_map_base.translation()).norm();
    }
    const double mean_m = sum_m / 160.0;
    EXPECT_LT(mean_m, how == PoseInterpolation::kOdometry ? 0.02 : 0.06) << static_cast<int>(how);
  }
}

TEST(NoddingMapper, AScanWithoutElevationHasAPoseAndNoPoint) {
  const NoddingOutcome outcome = map(standing(), {}, [](NoddingScan& scan, std::size_t k) {
    if (k >= 30 && k < 50) scan.knots.clear();
  });
  EXPECT_EQ(outcome.statistics.without_nod, 20U);
  EXPECT_EQ(outcome.poses.size(), 240U);
  for (const CloudPoint& point : outcome.cloud) EXPECT_FALSE(point.scan >= 30 && point.scan < 50);
}

TEST(NoddingMapper, NoElevationAtAllIsAnError) {
  const auto without = [](NoddingScan& scan, std::size_t) { scan.knots.clear(); };
  EXPECT_THAT([&] { map(standing(), {}, without); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("no ENCODER or TILT message")));
}

TEST(NoddingMapper, ScansBeforeTheFirstFixArePosedBackwards) {
  NoddingDrive drive = driving();
  drive.elevation_rad = [](double t) { return nod(t + 1.0, 4.0); };  // level for the first time after 3 s
  const NoddingOutcome outcome = map(drive);
  EXPECT_GT(outcome.statistics.before_first_fix, 40U);
  EXPECT_EQ(outcome.poses.size(), 240U);
  const Pose2 expected =
      between(drive.T_room_base(outcome.poses[outcome.statistics.before_first_fix].stamp_s), drive.T_room_base(0.0));
  EXPECT_NEAR(outcome.poses[0].T_map_base.x_m, expected.x_m, 0.01);
  EXPECT_NEAR(outcome.poses[0].T_map_base.y_m, expected.y_m, 0.01);
}

// A mount that stays up: the odometry leads on, one warning is given, and what waits does not grow.
TEST(NoddingMapper, BlindForLongItGoesOnByOdometry) {
  NoddingDrive drive = driving();
  drive.elevation_rad = [](double t) { return t < 4.0 ? nod(t, 4.0) : nod(std::min(t, 6.0), 4.0); };
  const NoddingOutcome outcome = map(drive, with([](NoddingConfig& config) { config.max_blind_s = 4.5; }));
  EXPECT_EQ(outcome.warnings.size(), 1U);
  EXPECT_GT(outcome.statistics.by_odometry, 100U);
  EXPECT_EQ(outcome.poses.size(), 240U);
  const Pose2 truth = between(drive.T_room_base(0.0), drive.T_room_base(outcome.poses.back().stamp_s));
  EXPECT_NEAR(outcome.poses.back().T_map_base.x_m, truth.x_m, 0.05);
}

// A clock that stands still: time says nothing, the number of scans that wait does.
TEST(NoddingMapper, WhatWaitsIsBoundedWhereTheClockStandsStill) {
  NoddingDrive drive = standing();
  drive.beams = 5;
  drive.mirror_rate_hz = 0.0;
  drive.elevation_rad = [](double) { return 0.5; };
  const auto frozen = [](NoddingScan& scan, std::size_t) { scan.record.scan.stamp_s = 1.0; };
  Job job;
  job.scans = 20100;
  EXPECT_THAT([&] { map(drive, job, frozen); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("no scan is horizontal")));
  job.scans = 20000;  // the bound itself holds all
  EXPECT_THROW(map(drive, job, frozen), InputError);
}

// Whichever call fails: the cloud is the CPU's, point for point.
TEST(NoddingMapper, ADeviceThatFailsCostsNoPoint) {
  const NoddingDrive drive = driving();
  const NoddingOutcome expected = map(drive);
  test::QueuedBackend counting;
  map(drive, {}, counting);
  for (std::uint64_t call = 1; call <= counting.calls().size(); ++call) {
    test::QueuedBackend failing(call);
    const NoddingOutcome outcome = map(drive, {}, failing);
    EXPECT_EQ(outcome.cloud, expected.cloud) << "call " << call << ", " << failing.calls().back();
    EXPECT_THAT(outcome.device_warning, testing::HasSubstr("goes on with the CPU"));
    EXPECT_EQ(failing.calls_after_failure(), 0U);
  }
}

TEST(NoddingMapper, WithoutLeaveToFallBackTheDeviceErrorIsThrown) {
  test::QueuedBackend failing(1);
  Job no_fallback;
  no_fallback.fall_back = false;
  EXPECT_THROW(map(driving(), no_fallback, failing), DeviceError);
}

}  // namespace
}  // namespace gdtslam
