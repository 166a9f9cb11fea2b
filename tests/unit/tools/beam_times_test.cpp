// The order and the times of a scan's beams, fitted to simulated sweeps, and put right in a log by map.
#include "engine/runs/motion/beam_times.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drive_log.hpp"
#include "engine/runs/log_look.hpp"
#include "engine/runs/streams/scan_motion.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/real_data.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::DriveLog;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kBeams = 180;
constexpr double kPeriod_s = 0.2;
constexpr double kSweep_s = kPeriod_s * (kBeams - 1) / kBeams;

/// To and fro in the room, turning at up to 0.9 rad/s.
Pose2 turning_drive(double t) {
  return {1.5 * std::sin(0.2 * t), 0.6 * std::sin(0.13 * t), 0.9 * std::sin(t) + 0.5 * std::sin(0.37 * t)};
}

Pose2 straight_drive(double t) { return {0.05 * t, 0.0, 0.3}; }

/// The scan as a laser of 360 degrees measures it that takes so long from the first beam to the last.
LaserScan swept(Pose2 (*pose_at)(double), double t, double sweep_s, Random& random) {
  static const std::vector<test::Segment> walls = test::furnished_room();
  LaserScan scan;
  scan.stamp_s = 1000.0 + t;
  scan.first_bearing_rad = -kPi;
  scan.bearing_step_rad = kTwoPi / kBeams;
  scan.max_range_m = 30.0;
  for (int k = 0; k < kBeams; ++k) {
    const double after_s = std::max(0.0, -sweep_s) + sweep_s * k / (kBeams - 1);
    const double bearing = scan.first_bearing_rad + k * scan.bearing_step_rad;
    const Pose2 ahead{0.0, 0.0, bearing + 0.5 * kPi};  // its one beam points to the right
    const float range_m = test::scan_of(walls, pose_at(t + after_s) * ahead, 0.0, 1).ranges_m[0];
    scan.ranges_m.push_back(range_m + static_cast<float>(0.01 * random.normal()));
  }
  return scan;
}

void say(double sweep_s, LaserScan& scan) {
  scan.first_beam_after_s = std::max(0.0, -sweep_s);
  scan.beam_period_s = sweep_s / (kBeams - 1);
}

std::optional<BeamTimes> fitted(Pose2 (*pose_at)(double), double true_sweep_s, double said_sweep_s) {
  Random random(5);
  BeamTimesFit fit;
  for (double t = 0.0; t < 30.0; t += kPeriod_s) {
    LaserScan scan = swept(pose_at, t, true_sweep_s, random);
    say(said_sweep_s, scan);
    fit.add(scan, pose_at(t));
  }
  return fit.fit({});
}

TEST(BeamTimes, TheSweepIsThatOfTheLaserWhateverTheLogSays) {
  for (const double sweep_s : {-kSweep_s, 0.0, 0.1, kSweep_s}) {
    for (const double said_s : {-kSweep_s, 0.0, 0.01, kSweep_s}) {
      const std::optional<BeamTimes> found = fitted(turning_drive, sweep_s, said_s);
      const bool is_wrong = std::fabs(sweep_s - said_s) > 0.02;
      ASSERT_EQ(found && found->stands_out(), is_wrong) << sweep_s << " " << said_s;
      if (!is_wrong) continue;
      EXPECT_NEAR(found->sweep_s, sweep_s, 0.01) << said_s;
      EXPECT_NEAR(found->sweep_s, sweep_s, 4.0 * found->sigma_s) << said_s;
    }
  }
}

TEST(BeamTimes, TheReverseOfTheLogsTimesIsStatedExactly) {
  const std::optional<BeamTimes> found = fitted(turning_drive, -kSweep_s, kSweep_s);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->first_beam_after_s, kSweep_s);
  EXPECT_DOUBLE_EQ(found->beam_period_s, -kSweep_s / (kBeams - 1));
  const LogFinding finding = found->finding();
  EXPECT_THAT(finding.what, HasSubstr("from the last to the first within 199 ms, not from the first to the last"));
  EXPECT_EQ(finding.options,
            "--set log.beam_times=stated --set log.first_beam_after=198.889ms --set log.beam_period=-1.11111ms");
}

TEST(BeamTimes, WithoutTurnsNothingIsClaimed) {
  EXPECT_FALSE(fitted(straight_drive, kSweep_s, -kSweep_s));
  EXPECT_FALSE(BeamTimesFit().fit({}));
}

/// A drive as a file of JSON lines. Its laser measures the last beam first.
class SweptLog : public testing::Test {
 protected:
  SweptLog() : path_(std::filesystem::temp_directory_path() / fmt::format("gdtslam_swept_{}.jsonl", ::getpid())) {}
  ~SweptLog() override { std::filesystem::remove(path_); }
  SweptLog(const SweptLog&) = delete;
  SweptLog& operator=(const SweptLog&) = delete;

  [[nodiscard]] std::string write(double said_sweep_s) const {
    Random random(6);
    std::ofstream file(path_);
    for (double t = 0.0; t < 30.0; t += kPeriod_s) {
      LaserScan scan = swept(turning_drive, t, -kSweep_s, random);
      say(said_sweep_s, scan);
      const Pose2 pose = turning_drive(t);
      file << fmt::format(
          R"({{"stamp":{},"odom":[{},{},{}],"mount":[0,0,0],"angle_min":{},"angle_increment":{},"first_beam_after":{},"time_increment":{},"range_max":30,"ranges":[{}]}})",
          scan.stamp_s, pose.x_m, pose.y_m, pose.theta_rad, scan.first_bearing_rad, scan.bearing_step_rad,
          scan.first_beam_after_s, scan.beam_period_s, fmt::join(scan.ranges_m, ","));
      file << "\n";
    }
    return path_;
  }

  DriveLog drive_;

 private:
  std::string path_;
};

TEST_F(SweptLog, MapPutsReversedTimesRight) {
  const test::MappedLog right = drive_.map(write(-kSweep_s));
  EXPECT_THAT(right.findings, IsEmpty());
  const test::MappedLog reversed = drive_.map(write(kSweep_s));
  ASSERT_EQ(reversed.findings.size(), 1U);
  EXPECT_THAT(reversed.findings[0].what, HasSubstr("measured from the last to the first"));
  EXPECT_TRUE(reversed.findings[0].is_mended);
  EXPECT_EQ(reversed.trajectory_sha256, right.trajectory_sha256);
}

class RealBeamTimes : public testing::TestWithParam<const char*> {};

TEST_P(RealBeamTimes, ARealLaserThatSweepsInMillisecondsIsNotAccused) {
  GDTSLAM_REAL_DATA(log, GetParam());
  EXPECT_THAT(motion_findings(motion_by_scans(log, {}, {}, {}, [] { return false; })), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Sick, RealBeamTimes,
                         testing::Values("slam2d/intel.clf.gz", "slam2d/fr079.clf.gz", "slam2d/mit-csail.clf.gz"));

// The driver of this Hokuyo, which turns anticlockwise at 10 Hz and was carried by hand, states its times rightly.
TEST(HokuyoBeamTimes, AreFoundFromItsScansWhateverIsSaid) {
  GDTSLAM_REAL_DATA(log, "rosbag/ccny_hokuyo_demo.bag.gz");
  for (const double share_said : {1.0, 0.0, -1.0}) {
    const std::unique_ptr<Backend> cpu = make_cpu_backend({});
    Mapper mapper({}, *cpu);
    BeamTimesFit fit;
    double right_s = 0.0;
    ScanStream scans({log}, {}, {});
    while (std::optional<ScanRecord> record = scans.next()) {
      LaserScan& scan = record->scan;
      right_s = scan.beam_period_s * static_cast<double>(scan.ranges_m.size() - 1);
      scan.first_beam_after_s = std::max(0.0, -share_said * right_s);
      scan.beam_period_s *= share_said;
      const MatchResult match = mapper.process(scan, std::nullopt);
      if (match.accepted) fit.add(scan, match.T_map_base);
    }
    const std::optional<BeamTimes> found = fit.fit({});
    ASSERT_EQ(found && found->stands_out(), share_said < 1.0) << share_said;
    EXPECT_NEAR(found ? found->sweep_s : right_s, right_s, 0.01) << share_said;
  }
}

}  // namespace
}  // namespace gdtslam
