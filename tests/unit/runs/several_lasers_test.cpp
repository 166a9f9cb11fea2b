// Two lasers back to back, half a circle each, that take turns: a drive out of a corridor into a room and back, whose
// poses are known. Wheels tell 1.5 % too much way and 2 % too little turn.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "engine/io/logs/carmen_writer.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "engine/runs/streams/scan_motion.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr double kStep_s = 0.1;

const std::vector<Pose2>& mounts() {
  static const std::vector<Pose2> both{{0.25, 0.1, 0.0}, {-0.25, -0.1, kPi}};
  return both;
}

/// A corridor of 14 m with a room beside it, and a pillar and a cupboard in that.
std::vector<test::Segment> corridor_and_room() {
  return {{{0.0, 0.0}, {14.0, 0.0}}, {{14.0, 0.0}, {14.0, 2.2}}, {{0.0, 2.2}, {0.0, 0.0}},   {{0.0, 2.2}, {6.4, 2.2}},
          {{7.7, 2.2}, {14.0, 2.2}}, {{6.4, 2.2}, {6.4, 2.6}},   {{7.7, 2.2}, {7.7, 2.6}},   {{4.0, 2.6}, {6.4, 2.6}},
          {{7.7, 2.6}, {11.0, 2.6}}, {{4.0, 2.6}, {4.0, 7.5}},   {{11.0, 2.6}, {11.0, 7.5}}, {{4.0, 7.5}, {11.0, 7.5}},
          {{9.0, 4.0}, {9.5, 4.0}},  {{9.5, 4.0}, {9.5, 4.6}},   {{9.0, 4.6}, {9.5, 4.6}},   {{9.0, 4.0}, {9.0, 4.6}},
          {{4.0, 6.5}, {5.2, 6.5}},  {{5.2, 6.5}, {5.2, 7.5}}};
}

/// Forward and to the left, a step each.
std::vector<Eigen::Vector2d> steps() {
  std::vector<Eigen::Vector2d> all;
  const auto add = [&all](int count, double forward_m, double turn_rad) {
    all.insert(all.end(), static_cast<std::size_t>(count), Eigen::Vector2d(forward_m, turn_rad));
  };
  add(10, 0.0, 0.0);
  add(120, 0.05, 0.0);
  add(25, 0.0, kPi / 50.0);
  add(70, 0.05, 0.0);
  add(50, 0.0, kPi / 50.0);
  add(70, 0.05, 0.0);
  add(25, 0.0, -kPi / 50.0);
  add(100, 0.05, 0.0);
  return all;
}

class TwoLasers : public testing::Test {
 protected:
  TwoLasers() : folder_(std::filesystem::temp_directory_path() / ("gdtslam-lasers-" + std::to_string(::getpid()))) {
    std::filesystem::create_directory(folder_);
    Random random(7);
    const std::vector<test::Segment> walls = corridor_and_room();
    Pose2 T_map_base{1.0, 1.1, 0.0};
    Pose2 T_odom_base;
    for (const Eigen::Vector2d& step : steps()) {
      T_map_base = T_map_base * exp_se2({step.x(), 0.0, step.y()});
      T_odom_base = T_odom_base * exp_se2({1.015 * step.x(), 0.0, 0.98 * step.y()});
      const std::size_t laser = truth_.size() % 2;
      const double stamp_s = kStep_s * static_cast<double>(truth_.size());
      truth_.push_back({stamp_s, T_map_base});
      ScanRecord record{.scan = test::scan_of(walls, T_map_base * mounts()[laser], stamp_s),
                        .T_odom_base = T_odom_base,
                        .laser = laser};
      record.scan.T_base_laser = mounts()[laser];
      for (float& range_m : record.scan.ranges_m) range_m += static_cast<float>(random.normal(0.0, 0.01));
      scans_.push_back(std::move(record));
    }
  }
  ~TwoLasers() override { std::filesystem::remove_all(folder_); }

  /// A log of one of them, or of all; its odometry is late by so many steps.
  [[nodiscard]] std::string log(std::optional<std::size_t> laser = {}, std::size_t late = 0) const {
    const std::string path = folder_ / (laser ? std::to_string(*laser) : "all");
    std::ofstream file(path);
    CarmenWriter writer(4);
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      ScanRecord scan = scans_[i];
      scan.T_odom_base = scans_[i - std::min(i, late)].T_odom_base;
      if (laser && scan.laser != *laser) continue;
      if (laser) scan.laser = 0;
      file << writer.scan(scan);
    }
    return path;
  }
  [[nodiscard]] MapOutcome mapped(const std::string& log, bool with_loops) const {
    MapRequest job{.logs = {log}, .with_loops = with_loops};
    job.settings.log.lasers = LogLasers::kAll;
    const std::unique_ptr<Backend> cpu = make_cpu_backend({});
    return MapRun(job, *cpu).run([](std::uint64_t, double) {}, [] { return false; });
  }
  [[nodiscard]] double ate_m(const MapOutcome& outcome) const {
    return evaluate_reference(outcome.trajectory, truth_, {}).ate_m.rmse;
  }

  std::filesystem::path folder_;
  Trajectory truth_;
  std::vector<ScanRecord> scans_;
};

TEST_F(TwoLasers, AreNoWorseThanTheBetterOneAlone) {
  for (const bool with_loops : {true, false}) {
    const MapOutcome both = mapped(log(), with_loops);
    ASSERT_EQ(both.trajectory.size(), truth_.size()) << "a pose for each scan";
    const double front_m = ate_m(mapped(log(0), with_loops));
    const double rear_m = ate_m(mapped(log(1), with_loops));
    EXPECT_LE(ate_m(both), std::min(front_m, rear_m) + 0.002) << front_m << ' ' << rear_m << ' ' << with_loops;
    EXPECT_LE(ate_m(both), 0.02);
    EXPECT_TRUE(both.doubtful.empty()) << both.doubtful.size() << " scans";
    EXPECT_NEAR(path_length_m(both.trajectory), path_length_m(truth_), 0.02 * path_length_m(truth_));
    EXPECT_EQ(both.statistics.scans, truth_.size());
    EXPECT_EQ(both.statistics.matched, truth_.size());
  }
}

TEST_F(TwoLasers, KeyframesHaveTheScansOfBoth) {
  const MapOutcome outcome = mapped(log(), true);
  ASSERT_EQ(outcome.keyframe_scans.size(), outcome.keyframes.size());
  std::size_t pairs = 0;
  for (std::size_t k = 0; k < outcome.keyframes.size(); ++k) {
    const std::size_t scan = outcome.keyframes[k];
    EXPECT_NEAR(outcome.keyframe_scans[k].stamp_s, truth_[scan].stamp_s, 1e-6);
    EXPECT_EQ(outcome.keyframe_scans[k].T_base_laser.x_m > 0.0, scans_[scan].laser == 0) << scan;
    pairs += k > 0 && outcome.keyframes[k - 1] + 1 == scan ? 1U : 0U;
  }
  EXPECT_GE(2 * pairs + 3, outcome.keyframes.size());
  ASSERT_TRUE(outcome.closed);
  EXPECT_EQ(outcome.closed->covariances.size(), truth_.size());
  for (const GraphPlace& place : outcome.closed->places) {
    EXPECT_TRUE(std::ranges::binary_search(outcome.keyframes, place.scan)) << place.scan;
  }
}

std::optional<OdometryDelay> delay_by_scans(const std::string& log) {
  ReadOptions options;
  options.all_lasers = true;
  return estimate_delay(to_headings(motion_by_scans(log, options, {}, {}, [] { return false; }).motions));
}

TEST_F(TwoLasers, ShowHowLateTheOdometryIs) {
  const std::optional<OdometryDelay> delay = delay_by_scans(log({}, 4));
  ASSERT_TRUE(delay);
  EXPECT_TRUE(delay->stands_out());
  EXPECT_NEAR(delay->delay_s, 4.0 * kStep_s, 0.05);
}

TEST_F(TwoLasers, OdometryThatIsStampedRightHasNoDelay) {
  const std::optional<OdometryDelay> delay = delay_by_scans(log());
  EXPECT_FALSE(delay && delay->stands_out()) << delay->delay_s;
}

// Whoever follows a live run gets a line for each scan, and the same poses.
TEST_F(TwoLasers, ALiveRunReportsEachScanInItsOrder) {
  MapRequest job{.logs = {log()}, .with_loops = false};
  job.settings.log.lasers = LogLasers::kAll;
  std::vector<StampedPose> reported;
  std::size_t ends = 0;
  job.scan_mapped = [&](const MappedScan& mapped) {
    EXPECT_EQ(mapped.scan.stamp_s, mapped.match.stamp_s);
    reported.push_back({mapped.match.stamp_s, mapped.match.T_map_base});
    ends += mapped.ends_observation ? 1U : 0U;
  };
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const MapOutcome live = MapRun(job, *cpu).run([](std::uint64_t, double) {}, [] { return false; });
  ASSERT_EQ(reported.size(), truth_.size());
  EXPECT_EQ(ends, truth_.size() / 2 + 1);
  for (std::size_t i = 0; i < reported.size(); ++i) {
    EXPECT_EQ(reported[i].stamp_s, live.trajectory[i].stamp_s);
    EXPECT_EQ(reported[i].T_map_base, live.trajectory[i].T_map_base);
  }
  EXPECT_EQ(mapped(job.logs.front(), false).trajectory.back().T_map_base, live.trajectory.back().T_map_base);
}

}  // namespace
}  // namespace gdtslam
