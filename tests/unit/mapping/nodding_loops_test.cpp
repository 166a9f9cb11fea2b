// A nodding laser's drive that comes back, with its loops closed, in a room that is known in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "support/nodding_drive.hpp"

namespace gdtslam {
namespace {

using test::NoddingDrive;

constexpr std::size_t kScansOfDrive = 2200;

// More than three times round, with wheels that read 6 % short.
NoddingDrive round_the_room() {
  NoddingDrive drive;
  drive.elevation_rad = [](double t) { return rad_from_deg(40.0) * (1.0 - std::cos(2.0 * kPi * t / 4.0)); };
  drive.mount = {.height_m = 0.5, .lever_forward_m = 0.04, .lever_up_m = 0.03};
  drive.mirror_rate_hz = 20.0;
  drive.odometry_scale = 0.94;
  drive.T_room_base = [](double t) {
    const double angle = 0.19 * t;
    return Pose2{0.5 + 1.6 * std::sin(angle), -0.2 - 1.6 * std::cos(angle), wrap_angle(angle)};
  };
  return drive;
}

struct LoopOutcome {
  std::vector<NoddingPose> poses;
  Cloud cloud;
  ClosedPath path;
  NoddingStatistics statistics;
};

LoopOutcome closed(const NoddingDrive& drive, MapperOptions options = {},
                   const std::function<bool(const LoopOutcome&)>& stop = {}) {
  LoopOutcome outcome;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  options.with_loops = true;
  Mapper mapper(nodding_mapper_config({}, {}), *cpu, options);
  CloudKeeper cloud;
  NoddingMapper nodding({}, test::scanner_of(drive), mapper, *cpu, cloud,
                        [&](const NoddingPose& pose, const NoddingScan&) { outcome.poses.push_back(pose); });
  for (std::size_t k = 0; k < kScansOfDrive; ++k) nodding.process(test::scan_of(drive, k));
  EXPECT_TRUE(outcome.poses.empty()) << "poses come when loops are closed";
  outcome.path = nodding.finish([](std::string_view, double) {}, [&] { return stop && stop(outcome); }).value();
  outcome.cloud = std::move(cloud.cloud);
  outcome.statistics = nodding.statistics();
  return outcome;
}

// Root of the mean square, the first poses laid on each other.
double error_m(const NoddingDrive& drive, const std::vector<NoddingPose>& poses) {
  double sum = 0.0;
  for (const NoddingPose& pose : poses) {
    const Pose2 truth = between(drive.T_room_base(0.0), drive.T_room_base(pose.stamp_s));
    const double off_m = (truth.translation() - pose.T_map_base.translation()).norm();
    sum += off_m * off_m;
  }
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

std::vector<NoddingPose> without_loops(const NoddingDrive& drive) {
  std::vector<NoddingPose> poses;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  Mapper mapper(nodding_mapper_config({}, {}), *cpu);
  CloudKeeper cloud;
  NoddingMapper nodding({}, test::scanner_of(drive), mapper, *cpu, cloud,
                        [&](const NoddingPose& pose, const NoddingScan&) { poses.push_back(pose); });
  for (std::size_t k = 0; k < kScansOfDrive; ++k) nodding.process(test::scan_of(drive, k));
  nodding.finish();
  return poses;
}

class NoddingLoops : public testing::Test {
 protected:
  /// The drive with its loops closed by a thread beside, once for all tests.
  static const LoopOutcome& whole() {
    static const LoopOutcome outcome = closed(round_the_room());
    return outcome;
  }
};

TEST_F(NoddingLoops, TheSweepsFollowTheClosedPath) {
  const NoddingDrive drive = round_the_room();
  const LoopOutcome& with = whole();
  EXPECT_TRUE(with.path.is_closed);
  ASSERT_EQ(with.poses.size(), kScansOfDrive);
  EXPECT_LT(error_m(drive, with.poses), 0.02);
  EXPECT_LT(error_m(drive, with.poses), error_m(drive, without_loops(drive)));
  const Pose3 T_room_map = embed(drive.T_room_base(0.0));
  double sum_m = 0.0;
  for (const CloudPoint& p : with.cloud) {
    const Point3 point(static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m));
    sum_m += test::distance_to_room_m(T_room_map * point);
  }
  EXPECT_GT(with.cloud.size(), 400000U);
  EXPECT_LT(sum_m / static_cast<double>(with.cloud.size()), 0.015);
}

TEST_F(NoddingLoops, NumbersOfTheClosedPathAreThoseOfAllScans) {
  const LoopOutcome& with = whole();
  ASSERT_EQ(with.path.T_map_base.size(), with.poses.size());
  ASSERT_EQ(with.path.covariances.size(), with.poses.size());
  for (std::size_t k = 0; k < with.poses.size(); ++k) {
    EXPECT_EQ(with.path.T_map_base[k], with.poses[k].T_map_base) << k;
    EXPECT_EQ(with.poses[k].scan, k);
  }
  const auto is_fix = [&](std::size_t scan) { return with.poses.at(scan).match.has_value(); };
  ASSERT_FALSE(with.path.keyframes.empty());
  for (const std::size_t keyframe : with.path.keyframes) EXPECT_TRUE(is_fix(keyframe)) << keyframe;
  ASSERT_GT(with.path.places.size(), 2U);
  for (const GraphPlace& place : with.path.places) EXPECT_TRUE(is_fix(place.scan)) << place.scan;
  for (const PathRelation& step : with.path.path) EXPECT_TRUE(is_fix(step.from) && is_fix(step.to)) << step.from;
  ASSERT_FALSE(with.path.loops.empty()) << "it came back";
  for (const ClosedLoop& loop : with.path.loops) {
    EXPECT_TRUE(is_fix(loop.from) && is_fix(loop.to)) << loop.from;
    const NoddingDrive drive = round_the_room();
    const Pose2 truth =
        between(drive.T_room_base(with.poses[loop.from].stamp_s), drive.T_room_base(with.poses[loop.to].stamp_s));
    EXPECT_LT((truth.translation() - loop.T_from_to.translation()).norm(), 0.1) << loop.from << " to " << loop.to;
  }
  // Between two fixes linear by the number of the scan.
  std::vector<std::size_t> fixes;
  for (std::size_t k = 0; k < with.poses.size(); ++k) {
    if (is_fix(k)) fixes.push_back(k);
  }
  for (std::size_t next = 1; next < fixes.size(); ++next) {
    const PoseCovariance& from = with.path.covariances[fixes[next - 1]];
    const PoseCovariance& to = with.path.covariances[fixes[next]];
    for (std::size_t k = fixes[next - 1]; k <= fixes[next]; ++k) {
      const double share =
          static_cast<double>(k - fixes[next - 1]) / static_cast<double>(fixes[next] - fixes[next - 1]);
      for (double PoseCovariance::*const of : {&PoseCovariance::xx, &PoseCovariance::xy, &PoseCovariance::xt,
                                               &PoseCovariance::yy, &PoseCovariance::yt, &PoseCovariance::tt}) {
        ASSERT_NEAR(with.path.covariances[k].*of, (1.0 - share) * from.*of + share * to.*of, 1e-12) << k;
      }
    }
  }
}

TEST_F(NoddingLoops, GivesTheSameBytesWithAndWithoutAThreadBeside) {
  const LoopOutcome alone = closed(round_the_room(), {.loops_beside = false});
  EXPECT_EQ(whole().path.T_map_base, alone.path.T_map_base);
  EXPECT_EQ(whole().cloud, alone.cloud);
}

// While scans are placed: the rest of the poses come, the rest of the points do not.
TEST_F(NoddingLoops, AStopEndsTheCloudAndNotThePath) {
  const LoopOutcome cut =
      closed(round_the_room(), {}, [](const LoopOutcome& so_far) { return so_far.poses.size() > 300; });
  EXPECT_TRUE(cut.path.is_closed);
  EXPECT_EQ(cut.poses.size(), whole().poses.size());
  ASSERT_FALSE(cut.cloud.empty());
  EXPECT_LT(cut.cloud.size(), whole().cloud.size() / 2);
  EXPECT_TRUE(std::equal(cut.cloud.begin(), cut.cloud.end(), whole().cloud.begin()));
}

// Before the loops are closed: the path as it was driven, and the points of all that came.
TEST_F(NoddingLoops, AStopBeforeLeavesThePathAsItWasDriven) {
  const LoopOutcome stopped = closed(round_the_room(), {}, [](const LoopOutcome&) { return true; });
  EXPECT_FALSE(stopped.path.is_closed);
  EXPECT_TRUE(stopped.path.covariances.empty());
  EXPECT_EQ(stopped.poses.size(), kScansOfDrive);
  EXPECT_GT(stopped.cloud.size(), 400000U);
  for (const std::size_t keyframe : stopped.path.keyframes) EXPECT_TRUE(stopped.poses.at(keyframe).match) << keyframe;
}

}  // namespace
}  // namespace gdtslam
