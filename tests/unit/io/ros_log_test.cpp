// The records of a log as messages of ROS: topics, times of receipt, speeds, what is left out. Numbers by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "engine/io/writers/ros_messages.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::Each;
using testing::ElementsAre;

template <class Value>
Value value_at(const std::string& bytes, std::size_t at) {
  Value value{};
  EXPECT_LE(at + sizeof(Value), bytes.size());
  if (at + sizeof(Value) <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof(Value));
  return value;
}

ScanRecord record_at(double stamp_s, std::size_t laser = 0, const Pose2& T_base_laser = {0.5, 0.0, 0.0}) {
  return {.scan = {.stamp_s = stamp_s,
                   .first_bearing_rad = -1.0,
                   .bearing_step_rad = 0.5,
                   .max_range_m = 20.0,
                   .ranges_m = {1.0F, 2.0F, 3.0F},
                   .T_base_laser = T_base_laser},
          .T_odom_base = std::nullopt,
          .laser = laser};
}

// Behind its header of 4 + 8 + 4 + 8 bytes a scan has its angles, the time of a beam and that of the scan.
constexpr std::size_t kScanFields = 4 + 8 + 4 + 8;

/// Whether each record is written to an MCAP file.
std::vector<bool> are_written(const std::vector<LogRecord>& records) {
  const test::TemporaryFolder folder;
  AtomicFileSet files;
  const auto log = make_log_writer(LogFormat::kMcap, folder / "a.mcap", {}, files);
  std::vector<bool> written;
  for (const LogRecord& record : records) written.push_back(log->write(record));
  EXPECT_EQ(log->left_out().empty(), std::find(written.begin(), written.end(), false) == written.end());
  return written;
}

TEST(RosLog, StampsLieBetween1970And2038) {
  const auto records_at = [](double stamp_s) {
    return std::vector<LogRecord>{Odometry{stamp_s, {}}, Tilt{stamp_s, 0.5}, Encoder{stamp_s, 1}, record_at(stamp_s)};
  };
  for (const double stamp_s : {0.0, 2147483647.5}) {
    EXPECT_THAT(are_written(records_at(stamp_s)), Each(true)) << stamp_s;
  }
  for (const double stamp_s : {-1e-9, kRosStampLimit_s, 1e300, std::nan("")}) {
    EXPECT_THAT(are_written(records_at(stamp_s)), Each(false)) << stamp_s;
  }
  // The stamp of the message is that of the beam that came first.
  ScanRecord early = record_at(0.5);
  early.scan.first_beam_after_s = -0.5;
  ScanRecord too_early = early;
  too_early.scan.first_beam_after_s = -0.625;
  ScanRecord turned = record_at(0.5);
  turned.scan.beam_period_s = -0.375;
  EXPECT_THAT(are_written({early, too_early, turned}), ElementsAre(true, false, false));
}

TEST(RosLog, CranksHave32BitsAndParametersAreLeftOut) {
  using Limits = std::numeric_limits<std::int32_t>;
  EXPECT_THAT(are_written({Encoder{1.0, Limits::min()}, Encoder{2.0, Limits::max()},
                           Encoder{3.0, std::int64_t{Limits::min()} - 1}, Encoder{4.0, std::int64_t{Limits::max()} + 1},
                           Parameter{"robot_width", "0.5"}}),
              ElementsAre(true, true, false, false, false));
}

// header, angles of the first and the last beam, step, time of a beam and of the scan, limits, ranges, intensities
TEST(RosScan, HasTheAnglesOfItsFirstAndLastBeam) {
  LaserScan scan = record_at(1.0).scan;
  scan.first_beam_after_s = 0.25;
  scan.beam_period_s = 0.125;
  const std::string bytes = ros_laser_scan(scan, "laser", 0.5);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 1U);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), 250'000'000U) << "the time of the first beam";
  std::vector<float> fields;
  for (std::size_t k = 0; k < 7; ++k) fields.push_back(value_at<float>(bytes, kScanFields + 4 * k));
  EXPECT_THAT(fields, ElementsAre(-1.0F, 0.0F, 0.5F, 0.125F, 0.5F, 0.0F, 20.0F));
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kScanFields + 28), 3U);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kScanFields + 28 + 4 + 12), 0U) << "no intensities";
  EXPECT_EQ(bytes.size(), kScanFields + 28 + 4 + 12 + 4);
  scan.max_range_m = 0.0;
  EXPECT_EQ(value_at<float>(ros_laser_scan(scan, "laser", 0.5), kScanFields + 24),
            std::numeric_limits<float>::infinity())
      << "a limit that is not known";
  scan.ranges_m.clear();
  const std::string bare = ros_laser_scan(scan, "laser", 0.5);
  EXPECT_EQ(value_at<float>(bare, kScanFields + 4), -1.0F) << "without beams the last is the first";
  EXPECT_EQ(bare.size(), kScanFields + 28 + 4 + 4);
}

/// A scan as a reader gives that of a laser which measures from left to right.
LaserScan turned_scan() {
  LaserScan scan = record_at(1.0).scan;
  scan.first_beam_after_s = 0.25;
  scan.beam_period_s = -0.125;
  return scan;
}

TEST(RosScan, ThatAReaderTurnedRoundReadsBack) {
  const test::TemporaryFolder folder;
  for (const double step_rad : {0.5, -0.5}) {
    ScanRecord written = record_at(1.0);
    written.scan = turned_scan();
    written.scan.bearing_step_rad = step_rad;
    AtomicFileSet files;
    const auto log = make_log_writer(LogFormat::kMcap, folder / "a.mcap", {}, files);
    EXPECT_TRUE(log->write(written));
    log->finish();
    files.commit();
    const auto reader = open_log(folder / "a.mcap", {});
    const auto read = std::get<ScanRecord>(reader->next().value());
    LaserScan expected = written.scan;
    if (step_rad < 0.0) turn_beams_round(expected);  // readers give beams from right to left
    EXPECT_EQ(read.scan.stamp_s, 1.0);
    EXPECT_EQ(read.scan.first_bearing_rad, expected.first_bearing_rad);
    EXPECT_EQ(read.scan.bearing_step_rad, 0.5);
    EXPECT_EQ(read.scan.first_beam_after_s, expected.first_beam_after_s);
    EXPECT_EQ(read.scan.beam_period_s, expected.beam_period_s);
    EXPECT_EQ(read.scan.ranges_m, expected.ranges_m);
  }
}

}  // namespace
}  // namespace gdtslam
