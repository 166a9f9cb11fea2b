// ROS 1 bags by a writer of the tests' own: scans, odometry, mounts, topics, and every kind of damage.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "bag_writer.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kScanType = "sensor_msgs/LaserScan";
constexpr const char* kOdometryType = "nav_msgs/Odometry";
constexpr const char* kTransformType = "tf2_msgs/TFMessage";

WholeLog drained_bag(const std::string& bytes, const ReadOptions& options = {}) {
  return drain(*open_bag(source_of(bytes_of(bytes)), "test.bag", options));
}

template <class Failure>
std::string bag_refusal(const std::string& bytes, const ReadOptions& options = {}) {
  return told_by<Failure>([&] { drained_bag(bytes, options); }, "no such error");
}

/// Scans at 10.0, 10.5, 11.0 between odometry at 10, 11, 12: a metre a second along x, a tenth of a radian a second.
std::string bag_drive() {
  std::string data = bag_connection(0, "/scan", kScanType) + bag_connection(1, "/odom", kOdometryType);
  data += bag_connection(2, "/camera", "sensor_msgs/Image") + bag_message(2, 10.0, std::string(5000, 'x'));
  for (const double stamp_s : {10.0, 10.5}) data += bag_message(0, stamp_s, ros_scan({.stamp_s = stamp_s}));
  for (const double stamp_s : {10.0, 11.0, 12.0}) {
    data += bag_message(1, stamp_s, ros_odometry(stamp_s, {.x_m = stamp_s - 10.0, .yaw_rad = 0.1 * (stamp_s - 10.0)}));
  }
  return data + bag_message(0, 13.0, ros_scan({.stamp_s = 11.0}));
}

TEST(Bag, ScansGetTheOdometryOfTheirOwnStampInEveryPacking) {
  for (const std::string packing : {"none", "bz2", "lz4"}) {
    const WholeLog log = drained_bag(bag_file(bag_chunk(bag_drive(), packing)));
    const auto scans = log.of<ScanRecord>();
    ASSERT_EQ(scans.size(), 3U) << packing;
    EXPECT_EQ(scans[0].scan.stamp_s, 10.0);
    EXPECT_THAT(scans[0].scan.ranges_m, ElementsAre(1.0F, 2.0F, 3.0F));
    EXPECT_EQ(scans[0].scan.first_bearing_rad, -1.0);
    EXPECT_EQ(scans[0].scan.bearing_step_rad, 0.5);
    EXPECT_EQ(scans[0].scan.max_range_m, 30.0);
    EXPECT_EQ(scans[0].T_odom_base, (Pose2{}));
    // Half a second along an arc of 0.1 rad and a chord of 1 m.
    EXPECT_NEAR(scans[1].T_odom_base->theta_rad, 0.05, 1e-12);
    EXPECT_NEAR(scans[1].T_odom_base->x_m, 0.5, 2e-3);
    EXPECT_NEAR(scans[2].T_odom_base->x_m, 1.0, 1e-12);
    EXPECT_NEAR(scans[2].T_odom_base->theta_rad, 0.1, 1e-12);
  }
}

// A real bag states 1,640 bytes for 82 entries.
TEST(Bag, AnIndexOfAWrongLengthIsPassedByItsEntries) {
  const std::string chunk = bag_chunk(bag_drive(), "none");
  for (const std::uint32_t stated : {24U, 40U, 0U, 0xffffffffU}) {
    const WholeLog log =
        drained_bag(bag_file(chunk + bag_index(0, 2, stated) + bag_message(0, 14.0, ros_scan({.stamp_s = 14.0}))));
    EXPECT_EQ(log.of<ScanRecord>().size(), 4U) << stated;
    EXPECT_EQ(log.warned("index of a wrong length"), stated == 24U ? 0U : 1U);
  }
}

// A quaternion of doubles tells an angle to some 1e-16, so that one of nine decimals is found again.
TEST(Bag, AHeadingOfFewDecimalsComesBackAsItWas) {
  const auto heading_of = [](double yaw_rad) {
    const std::string data = bag_connection(0, "/scan", kScanType) + bag_connection(1, "/odom", kOdometryType) +
                             bag_message(1, 1.0, ros_odometry(1.0, {.yaw_rad = yaw_rad})) +
                             bag_message(0, 1.0, ros_scan({.stamp_s = 1.0}));
    return drained_bag(bag_file(data)).of<ScanRecord>().at(0).T_odom_base->theta_rad;
  };
  for (const double yaw_rad : {0.0, 0.001, -0.004, 0.7853, 1.570796, -2.123456789, 3.141592, -3.141592653}) {
    EXPECT_EQ(heading_of(yaw_rad), yaw_rad);
  }
  for (int k = -3141; k <= 3141; k += 7) EXPECT_EQ(heading_of(k / 1000.0), k / 1000.0);
  for (const double yaw_rad : {1.0 / 3.0, -2.0 / 3.0, 0.5 * kPi}) EXPECT_NEAR(heading_of(yaw_rad), yaw_rad, 4e-15);
}

TEST(Bag, TheMountComesFromTheTreeOfFrames) {
  const auto scan_with = [](const std::string& transforms, const RosScan& scan, const ReadOptions& options = {}) {
    const std::string data = bag_connection(0, "/scan", kScanType) + bag_connection(1, "/tf_static", kTransformType);
    return drained_bag(bag_file(data + transforms + bag_message(0, 1.0, ros_scan(scan))), options);
  };
  const std::string chain =
      bag_message(1, 0.0, ros_transform(0.0, "base_link", "plate", {.x_m = 1.0, .yaw_rad = 0.5 * kPi})) +
      bag_message(1, 0.0, ros_transform(0.0, "/plate", "laser", {.x_m = 0.5, .y_m = 0.25}));
  WholeLog log = scan_with(chain, {.stamp_s = 1.0});
  Pose2 mount = log.of<ScanRecord>().at(0).scan.T_base_laser;
  EXPECT_NEAR(mount.x_m, 0.75, 1e-12);  // 1 - 0.25, turned by a quarter
  EXPECT_NEAR(mount.y_m, 0.5, 1e-12);
  EXPECT_NEAR(mount.theta_rad, 0.5 * kPi, 1e-12);
  EXPECT_EQ(log.warned("laser mount unknown"), 0U);
  log = scan_with("", {.stamp_s = 1.0});
  EXPECT_EQ(log.of<ScanRecord>().at(0).scan.T_base_laser, (Pose2{}));
  EXPECT_EQ(log.warned("laser mount unknown"), 1U);
  EXPECT_EQ(scan_with("", {.stamp_s = 1.0, .frame = "/base_link"}).warned("laser mount unknown"), 0U);
  log = scan_with(chain, {.stamp_s = 1.0}, {.T_base_laser = Pose2{9.0, 0.0, 0.0}});
  EXPECT_EQ(log.of<ScanRecord>().at(0).scan.T_base_laser.x_m, 9.0);
}

// Where a beam ends is the same point, whatever way round the laser turns or hangs.
TEST(Bag, BeamsGoFromRightToLeftAsSeenFromAbove) {
  const auto scan_of = [](const std::string& transforms, const RosScan& scan) {
    const std::string data = bag_connection(0, "/scan", kScanType) + bag_connection(1, "/tf", kTransformType);
    return drained_bag(bag_file(data + transforms + bag_message(0, 1.0, ros_scan(scan)))).of<ScanRecord>().at(0).scan;
  };
  const LaserScan clockwise = scan_of("", {.stamp_s = 1.0, .first_rad = 0.5F, .step_rad = -0.25F});
  EXPECT_THAT(clockwise.ranges_m, ElementsAre(3.0F, 2.0F, 1.0F));
  EXPECT_EQ(clockwise.first_bearing_rad, 0.0);
  EXPECT_EQ(clockwise.bearing_step_rad, 0.25);
  const std::string hung = bag_message(1, 0.0, ros_transform(0.0, "base_link", "laser", {.is_upside_down = true}));
  const LaserScan flipped = scan_of(hung, {.stamp_s = 1.0, .first_rad = -0.25F, .step_rad = 0.5F});
  EXPECT_THAT(flipped.ranges_m, ElementsAre(3.0F, 2.0F, 1.0F));
  EXPECT_EQ(flipped.first_bearing_rad, -0.75);  // the last beam, at +0.75 below, is to the right from above
  EXPECT_EQ(flipped.bearing_step_rad, 0.5);
}

TEST(Bag, WhatIsNoRangeIsNoReturn) {
  const float infinite = std::numeric_limits<float>::infinity();
  const RosScan scan{
      .stamp_s = 1.0, .least_m = 0.5F, .ranges_m = {0.0F, std::nanf(""), -infinite, infinite, 0.4F, -1.0F, 2.0F}};
  const WholeLog log =
      drained_bag(bag_file(bag_connection(0, "/scan", kScanType) + bag_message(0, 1.0, ros_scan(scan))));
  EXPECT_THAT(log.of<ScanRecord>().at(0).scan.ranges_m,
              ElementsAre(infinite, infinite, infinite, infinite, infinite, infinite, 2.0F));
}

TEST(Bag, SeveralTopicsAreToldWithTheirCounts) {
  std::string data = bag_connection(0, "/front", kScanType) + bag_connection(1, "/rear", kScanType);
  for (int k = 0; k < 3; ++k) data += bag_message(0, k, ros_scan({.stamp_s = 1.0 + k}));
  data += bag_message(1, 0.0, ros_scan({.stamp_s = 1.0, .ranges_m = {5.0F}})) + bag_message(0, 0.0, ros_scan({}));
  const std::string bag = bag_file(data);
  const std::string refused = bag_refusal<UsageError>(bag);
  EXPECT_THAT(refused, HasSubstr("/front (sensor_msgs/LaserScan, 4)"));
  EXPECT_THAT(refused, HasSubstr("/rear (sensor_msgs/LaserScan, 1)"));
  EXPECT_THAT(refused, HasSubstr("--topic"));
  for (const std::string topic : {"/rear", "rear"}) {
    ReadOptions options;
    options.topics.scans = {topic};
    EXPECT_EQ(drained_bag(bag, options).of<ScanRecord>().size(), 1U);
  }
  ReadOptions options;
  options.topics.scans = {"/none"};
  EXPECT_THAT(bag_refusal<UsageError>(bag, options), HasSubstr("/rear"));
  const std::string image = bag_file(bag_connection(0, "/camera", "sensor_msgs/Image") + bag_message(0, 1.0, "x"));
  EXPECT_THAT(bag_refusal<InputError>(image), HasSubstr("/camera (sensor_msgs/Image, 1)"));
}

TEST(BagDamage, ADamagedChunkIsAnErrorOrEndsTheLog) {
  const std::string good =
      bag_chunk(bag_connection(0, "/scan", kScanType) + bag_message(0, 1.0, ros_scan({.stamp_s = 1.0})), "none");
  std::string more;
  for (int k = 0; k < 200; ++k) more += bag_message(0, 2.0 + k, ros_scan({.stamp_s = 2.0 + k}));
  const std::string behind = bag_chunk(bag_message(0, 999.0, ros_scan({.stamp_s = 999.0})), "none");
  for (const std::string packing : {"bz2", "lz4"}) {
    std::string bad = bag_chunk(more, packing);
    bad[bad.size() / 2] = static_cast<char>(bad[bad.size() / 2] ^ 0x55);
    for (std::size_t k = 0; k < 6; ++k) bad[bad.size() - 40 + k] = static_cast<char>(bad[bad.size() - 40 + k] ^ 0x2a);
    const std::string bag = bag_file(good + bad + behind);
    EXPECT_THAT(bag_refusal<InputError>(bag), HasSubstr("--lenient")) << packing;
    const WholeLog log = drained_bag(bag, {.lenient = true});
    const auto scans = log.of<ScanRecord>();
    ASSERT_GE(scans.size(), 1U) << packing << ": the chunk before it";
    EXPECT_LT(scans.back().scan.stamp_s, 999.0) << packing << ": none behind it";
    EXPECT_EQ(log.warned("damaged recording"), 1U);
  }
}

TEST(BagDamage, MessagesThatContradictThemselvesAreErrorsOrCounted) {
  const std::string scan = ros_scan({.stamp_s = 2.0});
  std::string many = scan;
  many.replace(scan.size() - 4 - 3 * 4 - 4, 4, raw(std::uint32_t{0x40000000}));
  RosScan still{.stamp_s = 2.0, .step_rad = 0.0F};
  for (const std::string& bad : {many, scan.substr(0, 30), std::string(), ros_scan(still)}) {
    const std::string bag =
        bag_file(bag_connection(0, "/scan", kScanType) + bag_message(0, 1.0, ros_scan({.stamp_s = 1.0})) +
                 bag_message(0, 2.0, bad) + bag_message(0, 3.0, ros_scan({.stamp_s = 3.0})));
    EXPECT_NE(bag_refusal<InputError>(bag), "no such error");
    const WholeLog log = drained_bag(bag, {.lenient = true});
    EXPECT_EQ(log.records.size(), 2U);
    EXPECT_EQ(log.warned("malformed message"), 1U);
  }
}

TEST(BagDamage, NoNumberOfTheFileIsAllocated) {
  const std::string huge = raw(std::uint32_t{0xfffffff0});
  const std::string message =
      sized(bag_fields({{"op", op(2)}, {"conn", raw(std::uint32_t{0})}, {"time", ros_time(1.0)}}));
  const std::string start = bag_connection(0, "/scan", kScanType);
  for (const std::string& bytes :
       {bag_file(start + message + huge + "x"), bag_file(start + huge), bag_file(huge + "xyz"),
        bag_file(sized(bag_fields({{"op", op(5)}, {"compression", "none"}})) + huge)}) {
    EXPECT_NE(bag_refusal<InputError>(bytes), "no such error");
  }
  EXPECT_THAT(bag_refusal<InputError>("#ROSBAG V1.2\nrest"), HasSubstr("2.0"));
  EXPECT_THAT(bag_refusal<InputError>(bag_file(bag_chunk(start, "zip"))), HasSubstr("bz2"));
}

TEST(BagRealData, TheSameDriveAsItsCarmenLog) {
  GDTSLAM_REAL_DATA(path, "rosbag/mit-csail.sort.bag.gz");
  const WholeLog log = drain(*open_log(path, {}));
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 1988U);
  for (const ScanRecord& scan : scans) {
    ASSERT_EQ(scan.scan.ranges_m.size(), 361U);
    ASSERT_TRUE(scan.T_odom_base.has_value());
  }
}

TEST(BagRealData, AnIndexThatStatesAWrongLength) {
  GDTSLAM_REAL_DATA(path, "rosbag/ccny_hokuyo_demo.bag.gz");
  const WholeLog log = drain(*open_log(path, {}));
  const auto scans = log.of<ScanRecord>();
  EXPECT_EQ(scans.size(), 360U);  // by tests/fixtures/recordings/count.py, as the beams
  for (const ScanRecord& scan : scans) EXPECT_EQ(scan.scan.ranges_m.size(), 681U);
  EXPECT_EQ(log.warned("index of a wrong length"), 2U);
  EXPECT_EQ(log.warned("cut bag"), 0U);
}

}  // namespace
}  // namespace gdtslam
