// What is chosen of a recording, and how clocks, cranks and several lasers are joined. Expected values are those of the
// constructed messages.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "engine/io/recordings/recording_reader.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;

constexpr const char* kCdrScan = "sensor_msgs/msg/LaserScan";
constexpr const char* kCdrOdometry = "nav_msgs/msg/Odometry";

WholeLog chosen_log(const std::string& records, const ReadOptions& options = {}) {
  const std::string bytes = mcap_file(records);
  return drain(*open_mcap(source_of(bytes_of(bytes)), "test.mcap", options));
}

template <class Failure>
std::string choice_refusal(const std::string& records, const ReadOptions& options = {}) {
  return told_by<Failure>([&] { chosen_log(records, options); }, "no such error");
}

TEST(RecordingChoice, OdometryByItsTopicOrFromTransforms) {
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/wheels", kCdrOdometry, "cdr") +
                     mcap_channel(3, "/fused", kCdrOdometry, "cdr") +
                     mcap_channel(4, "/tf", "tf2_msgs/msg/TFMessage", "cdr");
  for (int k = 0; k < 4; ++k) {
    data += mcap_message(2, k, cdr_odometry(k, {.x_m = 1.0}));
    data += mcap_message(3, k, cdr_odometry(k, {.x_m = 2.0}));
    data += mcap_message(4, k, cdr_transform(k, "odom", "base_link", {.x_m = 3.0}));
    data += mcap_message(1, k, cdr_scan({.stamp_s = 1.0 * k}));
  }
  const auto x_of = [&](const std::string& topic) {
    ReadOptions options;
    options.topics.odometry = topic;
    return chosen_log(data, options).of<ScanRecord>().at(1).T_odom_base->x_m;
  };
  EXPECT_EQ(x_of(""), 1.0);
  EXPECT_EQ(x_of("/fused"), 2.0);
  EXPECT_EQ(x_of("fused"), 2.0);
  EXPECT_EQ(x_of("tf"), 3.0);
  ReadOptions options;
  options.topics.odometry = "/none";
  EXPECT_THAT(choice_refusal<UsageError>(data, options), HasSubstr("/fused (nav_msgs/Odometry, 4 at 1.0 Hz)"));
}

TEST(RecordingChoice, SeveralLasersComeInTheOrderOfTheirStamps) {
  std::string data = mcap_channel(1, "/front", kCdrScan, "cdr") + mcap_channel(2, "/rear", kCdrScan, "cdr") +
                     mcap_channel(3, "/odom", kCdrOdometry, "cdr") +
                     mcap_channel(4, "/tf_static", "tf2_msgs/msg/TFMessage", "cdr");
  data += mcap_message(4, 0.0, cdr_transform(0.0, "base_link", "laser_front", {.x_m = 0.5}));
  for (int k = 0; k < 4; ++k) {  // the rear laser's scans are recorded 0.3 s late
    data += mcap_message(3, k, cdr_odometry(k, {.x_m = 1.0 * k}));
    data += mcap_message(1, k + 0.2, cdr_scan({.stamp_s = k + 0.2, .frame = "laser_front"}));
    if (k > 0) data += mcap_message(2, k + 0.25, cdr_scan({.stamp_s = k - 0.05, .frame = "rear", .ranges_m = {4.0F}}));
  }
  EXPECT_THAT(choice_refusal<UsageError>(data), HasSubstr("--topic all"));
  const Pose2 T_base_rear{-0.5, 0.0, kPi};
  for (const std::vector<std::string>& topics :
       {std::vector<std::string>{"all"}, std::vector<std::string>{"/front", "/rear"}}) {
    ReadOptions options;
    options.topics.scans = topics;
    options.topics.mounts = {{"/rear", T_base_rear}};
    const WholeLog log = chosen_log(data, options);
    const auto scans = log.of<ScanRecord>();
    std::vector<double> stamps_s;
    std::vector<std::size_t> lasers;
    for (const ScanRecord& record : scans) {
      stamps_s.push_back(record.scan.stamp_s);
      lasers.push_back(record.laser);
      EXPECT_EQ(record.scan.T_base_laser.x_m, record.laser == 0 ? 0.5 : -0.5);
      EXPECT_EQ(record.scan.ranges_m.size(), record.laser == 0 ? 3U : 1U);
    }
    EXPECT_THAT(stamps_s, Pointwise(DoubleNear(1e-9), {0.2, 0.95, 1.2, 1.95, 2.2, 2.95, 3.2}));
    EXPECT_THAT(lasers, ElementsAre(0U, 1U, 0U, 1U, 0U, 1U, 0U));
    EXPECT_EQ(log.warned("beam count changed"), 0U);
    EXPECT_EQ(log.warned("backward stamp"), 0U);
  }
}

TEST(RecordingChoice, AMountIsOfATopicWithScans) {
  std::string data = mcap_channel(1, "/front", kCdrScan, "cdr") + mcap_channel(2, "/rear", kCdrScan, "cdr") +
                     mcap_channel(3, "/odom", kCdrOdometry, "cdr");
  for (int k = 0; k < 4; ++k) {
    for (const std::uint16_t laser : {std::uint16_t{1}, std::uint16_t{2}})
      data += mcap_message(laser, k, cdr_scan({.stamp_s = 1.0 * k}));
    data += mcap_message(3, k, cdr_odometry(k, {}));
  }
  ReadOptions options;
  options.topics.scans = {"/front"};
  for (const char* const topic : {"/front", "front", "/rear"}) {  // the last one is not read
    options.topics.mounts = {{topic, Pose2{0.5, 0.0, 0.0}}};
    EXPECT_EQ(chosen_log(data, options).of<ScanRecord>().size(), 4U) << topic;
  }
  for (const char* const topic : {"/fronr", "/odom", ""}) {
    options.topics.mounts = {{topic, Pose2{0.5, 0.0, 0.0}}};
    const WholeLog log = chosen_log(data, options);
    EXPECT_EQ(log.of<ScanRecord>().size(), 4U) << "what was read is not lost";
    ASSERT_EQ(log.warned("mount of a topic without scans"), 1U) << topic;
  }
}

// The laser counts from its own start, 1,000 s behind the odometry. A scan is sent when its last beam is measured, here
// 0.2 s after its stamp; messages take 0 to 30 ms.
TEST(RecordingClocks, AnOffsetIsMeasuredByTheTimesOfReceipt) {
  const double offset_s = 1000.0;
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/odom", kCdrOdometry, "cdr");
  for (int k = 0; k < 40; ++k) {
    const double at_s = offset_s + 0.5 * k;
    const double delay_s = 0.01 * (k % 4);
    data += mcap_message(2, at_s + delay_s, cdr_odometry(at_s, {.x_m = at_s}));
    const RosScan scan{.stamp_s = at_s + 0.1 - offset_s, .beam_period_s = 0.1F};
    data += mcap_message(1, at_s + 0.1 + 0.2 + 0.03 - delay_s, cdr_scan(scan));
  }
  const WholeLog log = chosen_log(data);
  EXPECT_EQ(log.warned("clocks differ"), 1U);
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 40U);
  for (const ScanRecord& record : scans) {
    if (!record.T_odom_base || record.scan.stamp_s > 19.0) continue;
    EXPECT_NEAR(record.T_odom_base->x_m, record.scan.stamp_s + offset_s, 0.001);
  }
  EXPECT_TRUE(scans[20].T_odom_base.has_value());
  ReadOptions stated;
  stated.clock_offset_s = -offset_s + 0.25;
  const WholeLog moved = chosen_log(data, stated);
  EXPECT_EQ(moved.warned("clocks differ"), 0U);
  EXPECT_NEAR(moved.of<ScanRecord>().at(20).T_odom_base->x_m, 10.1 + offset_s - 0.25, 1e-9);
}

TEST(RecordingClocks, DelaysOfMessagesAreNoOtherClock) {
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/odom", kCdrOdometry, "cdr");
  for (int k = 0; k < 10; ++k) {
    data += mcap_message(2, k + 0.4, cdr_odometry(k, {.x_m = 1.0 * k})) +
            mcap_message(1, k, cdr_scan({.stamp_s = k - 0.25}));
  }
  const WholeLog log = chosen_log(data);
  EXPECT_EQ(log.warned("clocks differ"), 0U);
  EXPECT_NEAR(log.of<ScanRecord>().at(5).T_odom_base->x_m, 4.75, 1e-12);
}

// docs/formats.md: a header without stamp gets the time of receipt.
TEST(RecordingClocks, HeadersWithoutStampsHaveThatOfTheirReceipt) {
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/odom", kCdrOdometry, "cdr");
  for (int k = 0; k < 10; ++k) {
    data += mcap_message(2, 50.0 + k, cdr_odometry(0.0, {.x_m = 1.0 * k}));
    data += mcap_message(1, 50.5 + k, cdr_scan({.stamp_s = 0.0}));
  }
  const WholeLog log = chosen_log(data);
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 10U);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(scans[k].T_odom_base.value().x_m, 0.5 + static_cast<double>(k), 1e-9);
  EXPECT_EQ(log.warned("scan without stamp"), 10U);
  EXPECT_EQ(log.warned("odometry without stamp"), 10U);
  EXPECT_EQ(log.warned("odometry steps back in time"), 0U);
}

// A simulator's clock begins at 0, while the recorder's is that of the wall.
TEST(RecordingClocks, AStampOfZeroIsATimeWhereTheNextOneIsLater) {
  constexpr double kWall_s = 1.7e9;
  const std::string channels =
      mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/odom", kCdrOdometry, "cdr");
  for (const double first_scan_s : {0.0, 0.05}) {
    std::string data = channels;
    for (int k = 0; k < 20; ++k) {
      const double odometry_s = 0.1 * k;
      const double scan_s = first_scan_s + 0.1 * k;
      data += mcap_message(2, kWall_s + odometry_s, cdr_odometry(odometry_s, {.x_m = odometry_s}));
      data += mcap_message(1, kWall_s + scan_s, cdr_scan({.stamp_s = scan_s}));
    }
    const WholeLog log = chosen_log(data);
    const auto scans = log.of<ScanRecord>();
    ASSERT_EQ(scans.size(), 20U);
    for (std::size_t k = 0; k < 20; ++k) {
      EXPECT_NEAR(scans[k].scan.stamp_s, first_scan_s + 0.1 * static_cast<double>(k), 1e-9);
      ASSERT_TRUE(scans[k].T_odom_base) << k;
      EXPECT_NEAR(scans[k].T_odom_base->x_m, std::min(scans[k].scan.stamp_s, 1.9), 1e-6);
    }
    for (const char* kind : {"scan without stamp", "odometry without stamp", "odometry steps back in time",
                             "odometry's clock was set back", "clocks differ"}) {
      EXPECT_EQ(log.warned(kind), 0U) << kind;
    }
  }
}

// A driver whose first message came before its clock did.
TEST(RecordingClocks, AStampOfZeroIsNoneWhereTheNextOneIsOfAnotherClock) {
  constexpr double kWall_s = 1.7e9;
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/odom", kCdrOdometry, "cdr");
  for (int k = 0; k < 20; ++k) {
    const double at_s = kWall_s + 0.1 * k;
    data += mcap_message(2, at_s, cdr_odometry(k == 0 ? 0.0 : at_s, {.x_m = 0.1 * k}));
    data += mcap_message(1, at_s + 0.05, cdr_scan({.stamp_s = k == 0 ? 0.0 : at_s + 0.05}));
  }
  const WholeLog log = chosen_log(data);
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 20U);
  EXPECT_NEAR(scans[0].scan.stamp_s, kWall_s + 0.05, 1e-6);
  EXPECT_NEAR(scans[0].T_odom_base.value().x_m, 0.05, 1e-6);
  EXPECT_EQ(log.warned("scan without stamp"), 1U);
  EXPECT_EQ(log.warned("odometry without stamp"), 1U);
}

TEST(RecordingCranks, NumbersAreTicksOrTilts) {
  std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/servo", "std_msgs/msg/Int32", "cdr");
  for (int k = 0; k < 3; ++k) {
    data += mcap_message(2, 500.0 + k, CdrWriter().put(std::int32_t{88 + k}).bytes());
    data += mcap_message(1, 500.25 + k, cdr_scan({.stamp_s = 0.25 + k}));  // another clock, 500 s behind
  }
  ReadOptions options;
  options.topics.crank = "servo";
  const auto ticks = chosen_log(data, options).of<Encoder>();
  ASSERT_EQ(ticks.size(), 3U);
  EXPECT_EQ(ticks[2].ticks, 90);
  EXPECT_NEAR(ticks[2].stamp_s, 2.0, 1e-6) << "in the laser's clock";
  options.crank = {.kind = CrankKind::kTilt, .step_rad = rad_from_deg(1.0), .zero = 90.0};
  const auto tilts = chosen_log(data, options).of<Tilt>();
  ASSERT_EQ(tilts.size(), 3U);
  EXPECT_NEAR(tilts[0].elevation_rad, rad_from_deg(-2.0), 1e-12);
  EXPECT_EQ(tilts[2].elevation_rad, 0.0);
  options.crank = {.kind = CrankKind::kTilt};
  EXPECT_THAT(choice_refusal<UsageError>(data, options), HasSubstr("log.crank_step"));
  options.topics.crank = "/none";
  EXPECT_THAT(choice_refusal<UsageError>(data, options), HasSubstr("/servo (std_msgs/Int32, 3"));
  EXPECT_TRUE(chosen_log(data).of<Encoder>().empty()) << "unless asked for";
}

// One that is told when it changes: the first message lies before the scans that it is of, however late the second is.
TEST(RecordingCranks, TheFirstMessageKeepsItsPlace) {
  for (const bool is_joint : {false, true}) {
    std::string data = mcap_channel(1, "/scan", kCdrScan, "cdr") +
                       mcap_channel(2, "/crank", is_joint ? "sensor_msgs/msg/JointState" : "std_msgs/msg/Int32", "cdr");
    const auto crank = [&](double at_s) {
      return mcap_message(2, at_s,
                          is_joint ? cdr_joints(at_s, {"tilt"}, {0.25}) : CdrWriter().put(std::int32_t{7}).bytes());
    };
    data += crank(0.0);
    for (int k = 0; k < 30; ++k) data += mcap_message(1, 0.05 + 0.1 * k, cdr_scan({.stamp_s = 0.05 + 0.1 * k}));
    data += crank(4.0);
    ReadOptions options;
    options.topics.crank = "/crank";
    if (is_joint) options.crank = {.kind = CrankKind::kTilt};
    const WholeLog log = chosen_log(data, options);
    ASSERT_EQ(log.records.size(), 32U);
    EXPECT_FALSE(std::holds_alternative<ScanRecord>(log.records.front())) << is_joint;
    EXPECT_FALSE(std::holds_alternative<ScanRecord>(log.records.back())) << is_joint;
  }
}

TEST(RecordingCranks, AJointIsChosenByItsName) {
  std::string data =
      mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_channel(2, "/joints", "sensor_msgs/msg/JointState", "cdr");
  for (int k = 0; k < 2; ++k) {
    data += mcap_message(2, k, cdr_joints(k + 0.5, {"wheel", "tilt"}, {7.0, 0.25 + k}));
    data += mcap_message(1, k, cdr_scan({.stamp_s = k + 0.5}));
  }
  ReadOptions options;
  options.crank.kind = CrankKind::kTilt;
  options.topics.crank = "/joints:tilt";
  const auto tilts = chosen_log(data, options).of<Tilt>();
  ASSERT_EQ(tilts.size(), 2U);
  EXPECT_EQ(tilts[1].elevation_rad, 1.25);
  EXPECT_EQ(tilts[1].stamp_s, 1.5);
  options.topics.crank = "/joints";
  EXPECT_EQ(chosen_log(data, options).of<Tilt>().at(0).elevation_rad, 7.0);
  options.topics.crank = "/joints:none";
  EXPECT_THAT(choice_refusal<InputError>(data, options), HasSubstr("none"));
  options.topics.crank = "/joints:tilt";
  options.crank = {.kind = CrankKind::kTicks, .step_rad = 0.125};
  EXPECT_EQ(chosen_log(data, options).of<Encoder>().at(1).ticks, 10);
}

TEST(RecordingScans, TheFirstEchoOfEachBeamCounts) {
  const std::string data =
      mcap_channel(1, "/echoes", "sensor_msgs/msg/MultiEchoLaserScan", "cdr") +
      mcap_message(1, 1.0, cdr_echo_scan({.stamp_s = 1.0}, {{1.0F, 2.0F}, {}, {3.0F}, {4.0F, 5.0F, 6.0F}}));
  EXPECT_THAT(chosen_log(data).of<ScanRecord>().at(0).scan.ranges_m,
              ElementsAre(1.0F, std::numeric_limits<float>::infinity(), 3.0F, 4.0F));
}

// Beam k of the message was measured at k periods after the stamp; once the beams are turned round, so are their times.
TEST(RecordingScans, EachBeamHasItsTime) {
  const auto scan_of = [](const RosScan& scan) {
    return chosen_log(mcap_channel(1, "/scan", kCdrScan, "cdr") + mcap_message(1, 1.0, cdr_scan(scan)))
        .of<ScanRecord>()
        .at(0)
        .scan;
  };
  const LaserScan left = scan_of({.stamp_s = 1.0, .beam_period_s = 0.125F});
  EXPECT_EQ(left.first_beam_after_s, 0.0);
  EXPECT_EQ(left.beam_period_s, 0.125);
  const LaserScan right = scan_of({.stamp_s = 1.0, .step_rad = -0.5F, .beam_period_s = 0.125F});
  EXPECT_EQ(right.first_beam_after_s, 0.25);
  EXPECT_EQ(right.beam_period_s, -0.125);
  for (const float unsaid_s : {0.0F, std::nanf(""), 1000.0F}) {
    const LaserScan scan = scan_of({.stamp_s = 1.0, .step_rad = -0.5F, .beam_period_s = unsaid_s});
    EXPECT_EQ(scan.first_beam_after_s, 0.0);
    EXPECT_EQ(scan.beam_period_s, 0.0);
  }
}

}  // namespace
}  // namespace gdtslam
