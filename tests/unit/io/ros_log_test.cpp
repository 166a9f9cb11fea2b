// The records of a log as messages of ROS: topics, times of receipt, speeds, what is left out. Numbers by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/writers/ros_log.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// What a container was given, in its order.
struct Taken {
  struct Channel {
    std::string topic;
    RosType type;
    bool is_latched;
  };
  struct Message {
    std::string topic;
    std::int64_t received_ns;
    std::string bytes;
  };
  std::vector<Channel> channels;
  std::vector<Message> messages;
  [[nodiscard]] std::vector<std::string> topics() const {
    std::vector<std::string> topics;
    for (const Message& message : messages) topics.push_back(message.topic);
    return topics;
  }
  [[nodiscard]] const Message& last(const std::string& topic) const {
    for (auto message = messages.rbegin(); message != messages.rend(); ++message) {
      if (message->topic == topic) return *message;
    }
    throw std::out_of_range(topic);
  }
};

class TakingContainer final : public RosContainer {
 public:
  explicit TakingContainer(Taken& taken) : taken_(taken) {}
  std::uint32_t add_channel(const std::string& topic, RosType type, bool is_latched) override {
    taken_.channels.push_back({topic, type, is_latched});
    return static_cast<std::uint32_t>(taken_.channels.size() - 1);
  }
  void add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) override {
    taken_.messages.push_back({taken_.channels.at(channel).topic, received_ns, std::string(message)});
  }
  void finish() override {}
  [[nodiscard]] std::uint64_t bytes() const override { return 0; }

 private:
  Taken& taken_;
};

class RosLogTest : public testing::Test {
 protected:
  Taken taken_;
  RosLog log_{std::make_unique<TakingContainer>(taken_)};

  [[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> left_out() const {
    std::vector<std::pair<std::string, std::uint64_t>> kinds;
    for (const LogReader::Warning& warning : log_.left_out()) kinds.emplace_back(warning.kind, warning.count);
    return kinds;
  }
};

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

TEST_F(RosLogTest, EachLaserHasItsTopicAndItsMount) {
  log_.write(record_at(1.0));
  log_.write(record_at(1.0, 1));
  log_.write(record_at(2.0));
  EXPECT_THAT(taken_.topics(), ElementsAre("/tf_static", "/scan", "/tf_static", "/scan_2", "/scan"));
  ASSERT_EQ(taken_.channels.size(), 3U);
  EXPECT_TRUE(taken_.channels[0].is_latched);
  EXPECT_FALSE(taken_.channels[1].is_latched);
  EXPECT_THAT(taken_.last("/scan").bytes, HasSubstr(std::string("\6\0\0\0laser", 10)));
  EXPECT_THAT(taken_.last("/scan_2").bytes, HasSubstr("laser_2"));
}

// Behind its header of 4 + 8 + 4 + 8 bytes a scan has its angles, the time of a beam and that of the scan. The name of
// the frame, "laser" or "laser_2", has 8 bytes with what fills it up.
constexpr std::size_t kScanFields = 4 + 8 + 4 + 8;

TEST_F(RosLogTest, TheTimeOfAScanIsThatSinceTheLastOfItsLaser) {
  const auto scan_time_s = [&](double stamp_s, std::size_t laser) {
    log_.write(record_at(stamp_s, laser));
    return value_at<float>(taken_.messages.back().bytes, kScanFields + 4 * sizeof(float));
  };
  EXPECT_EQ(scan_time_s(10.0, 0), 0.0F);
  EXPECT_EQ(scan_time_s(10.25, 1), 0.0F);
  EXPECT_EQ(scan_time_s(10.5, 0), 0.5F);
  EXPECT_EQ(scan_time_s(10.5, 1), 0.25F);
  EXPECT_EQ(scan_time_s(10.25, 0), 0.0F) << "back in time";
  EXPECT_EQ(scan_time_s(10.375, 0), 0.125F);
}

TEST_F(RosLogTest, ReceivedIsNeverBeforeWhatCameBut) {
  log_.write(Tilt{2.0, 0.5});
  log_.write(Tilt{1.5, 0.5});
  log_.write(Tilt{2.25, 0.5});
  log_.write(Encoder{1.0, 7});  // its message has no stamp of its own
  std::vector<std::int64_t> received_ns;
  for (const Taken::Message& message : taken_.messages) received_ns.push_back(message.received_ns);
  EXPECT_THAT(received_ns, ElementsAre(2'000'000'000, 2'000'000'000, 2'250'000'000, 1'000'000'000));
}

// Of nav_msgs/Odometry the speeds are the 6 doubles before the last 36.
TEST_F(RosLogTest, SpeedsAreThoseSinceTheOdometryBefore) {
  const auto speeds = [&](const Odometry& odometry) {
    log_.write(odometry);
    const std::string& bytes = taken_.last("/odom").bytes;
    const std::size_t at = bytes.size() - (36 + 6) * sizeof(double);
    return std::pair(value_at<double>(bytes, at), value_at<double>(bytes, at + 5 * sizeof(double)));
  };
  EXPECT_EQ(speeds({10.0, {1.0, 2.0, kPi / 2}}), std::pair(0.0, 0.0)) << "nothing is known";
  // Half a metre along +y, where the robot looks, in a quarter of a second.
  const auto [forward, turn] = speeds({10.25, {1.0, 2.5, kPi / 2}});
  EXPECT_NEAR(forward, 2.0, 1e-12);
  EXPECT_NEAR(turn, 0.0, 1e-12);
  // A quarter of a turn to the right on the spot in two seconds.
  const auto [still, right] = speeds({12.25, {1.0, 2.5, 0.0}});
  EXPECT_NEAR(still, 0.0, 1e-12);
  EXPECT_NEAR(right, -kPi / 4, 1e-12);
  // Of one stamp, or back in time, the speed before goes on.
  EXPECT_EQ(speeds({12.25, {9.0, 9.0, 0.0}}), std::pair(still, right));
  EXPECT_EQ(speeds({12.0, {0.0, 0.0, 0.0}}), std::pair(still, right));
}

TEST_F(RosLogTest, TheSameOdometryIsWrittenOnce) {
  log_.write(Odometry{1.0, {1.0, 2.0, 0.5}});
  ScanRecord scan = record_at(1.0);
  scan.T_odom_base = Pose2{1.0, 2.0, 0.5};
  log_.write(scan);
  EXPECT_THAT(taken_.topics(), ElementsAre("/odom", "/tf", "/tf_static", "/scan"));
  scan.T_odom_base = Pose2{1.0, 2.0, 0.625};  // another at the same time
  log_.write(scan);
  EXPECT_THAT(taken_.topics(), ElementsAre("/odom", "/tf", "/tf_static", "/scan", "/odom", "/tf", "/scan"));
  log_.write(Odometry{1.5, {1.0, 2.0, 0.625}});  // the same place later
  EXPECT_EQ(taken_.messages.size(), 9U);
}

TEST_F(RosLogTest, StampsLieBetween1970And2038) {
  const double below_s = std::nextafter(kRosStampLimit_s, 0.0);
  for (const double stamp_s : {0.0, 2147483647.5}) {
    log_.write(Odometry{stamp_s, {stamp_s, 0.0, 0.0}});
    log_.write(Tilt{stamp_s, 0.5});
    log_.write(Encoder{stamp_s, 1});
    log_.write(record_at(stamp_s));
  }
  EXPECT_TRUE(left_out().empty());
  EXPECT_EQ(taken_.messages.size(), 2U * 5U + 1U) << "and a mount";
  for (const double stamp_s : {-1e-9, kRosStampLimit_s, 1e300, std::nan("")}) {
    log_.write(Odometry{stamp_s, {}});
    log_.write(Tilt{stamp_s, 0.5});
    log_.write(Encoder{stamp_s, 1});
    log_.write(record_at(stamp_s));
  }
  EXPECT_THAT(left_out(), ElementsAre(std::pair("stamp that ROS does not know", 16U)));
  EXPECT_EQ(taken_.messages.size(), 11U);
  // The stamp of the message is that of its first beam.
  ScanRecord early = record_at(0.5);
  early.scan.first_beam_after_s = -0.5;
  log_.write(early);
  EXPECT_EQ(taken_.messages.size(), 12U);
  early.scan.first_beam_after_s = -0.625;
  log_.write(early);
  ScanRecord late = record_at(below_s);
  late.scan.first_beam_after_s = 1.0;
  log_.write(late);
  EXPECT_EQ(taken_.messages.size(), 12U);
  ScanRecord turned = record_at(0.5);  // the last of its three beams came first
  turned.scan.beam_period_s = -0.375;
  EXPECT_FALSE(log_.write(turned));
  turned.scan.first_beam_after_s = 0.25;
  EXPECT_TRUE(log_.write(turned));
}

TEST_F(RosLogTest, CranksHave32Bits) {
  using Limits = std::numeric_limits<std::int32_t>;
  log_.write(Encoder{1.0, Limits::min()});
  log_.write(Encoder{2.0, Limits::max()});
  log_.write(Encoder{3.0, std::int64_t{Limits::min()} - 1});
  log_.write(Encoder{4.0, std::int64_t{Limits::max()} + 1});
  ASSERT_EQ(taken_.messages.size(), 2U);
  EXPECT_EQ(value_at<std::int32_t>(taken_.messages[0].bytes, 4), Limits::min());
  EXPECT_EQ(value_at<std::int32_t>(taken_.messages[1].bytes, 4), Limits::max());
  EXPECT_THAT(left_out(), ElementsAre(std::pair("crank beyond 32 bits", 2U)));
}

TEST_F(RosLogTest, ParametersAreLeftOut) {
  log_.write(Parameter{"robot_width", "0.5"});
  EXPECT_THAT(left_out(), ElementsAre(std::pair("parameter", 1U)));
  EXPECT_TRUE(taken_.messages.empty());
}

// Nanoseconds are those of the text: 0.1 s and such have no exact double.
TEST(RosTime, IsRoundedToTheNanosecond) {
  EXPECT_EQ(ros_time_ns(0.0), 0);
  EXPECT_EQ(ros_time_ns(0.1), 100'000'000);
  EXPECT_EQ(ros_time_ns(1.0000000004), 1'000'000'000);
  EXPECT_EQ(ros_time_ns(1.0000000006), 1'000'000'001);
  EXPECT_EQ(ros_time_ns(1700000000.25), 1'700'000'000'250'000'000);
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

TEST(RosScan, IsStampedWithTheBeamThatWasMeasuredFirst) {
  for (const double step_rad : {0.5, -0.5}) {
    LaserScan scan = turned_scan();
    scan.bearing_step_rad = step_rad;
    EXPECT_EQ(ros_scan_stamp_s(scan), 1.0);
    const std::string bytes = ros_laser_scan(scan, "laser", 0.5);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 1U);
    EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), 0U);
    const double last_rad = -1.0 + 2.0 * step_rad;
    std::vector<float> fields;
    for (std::size_t k = 0; k < 4; ++k) fields.push_back(value_at<float>(bytes, kScanFields + 4 * k));
    EXPECT_THAT(fields, ElementsAre(static_cast<float>(last_rad), -1.0F, static_cast<float>(-step_rad), 0.125F));
    EXPECT_EQ(value_at<float>(bytes, kScanFields + 28 + 4), 3.0F) << "the range of the last beam";
  }
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

// What rosbag2 writes of a publisher: 1 is "keep last", "reliable", "transient local" and "automatic", 2 "volatile".
TEST(Ros2Quality, LatchedTopicsKeepTheirLastMessage) {
  EXPECT_THAT(ros2_service_quality(true), HasSubstr("depth: 1\n  reliability: 1\n  durability: 1\n"));
  EXPECT_THAT(ros2_service_quality(false), HasSubstr("depth: 10\n  reliability: 1\n  durability: 2\n"));
}

}  // namespace
}  // namespace gdtslam
