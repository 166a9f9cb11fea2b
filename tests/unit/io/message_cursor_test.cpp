// Fields of messages by the rules of their encodings: packed in ROS 1; in CDR (OMG formal/21-11-02) aligned to their
// own size behind the first four bytes, in its second version to four bytes at most.
#include "engine/io/recordings/message_cursor.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/recordings/messages.hpp"
#include "gdtslam/core/angle.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;

std::string cdr_head(int kind) { return {static_cast<char>(kind / 256), static_cast<char>(kind % 256), '\0', '\0'}; }

template <class Read>
std::string fault_of_recording(const Read& read) {
  return told_by<RecordingFault>(read);
}

TEST(MessageCursor, OfCdrThePlainEncodingsAreRead) {
  for (const int kind : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 256, 257, 262, 65535}) {
    const std::string fault =
        fault_of_recording([kind] { (void)MessageCursor(cdr_head(kind), MessageEncoding::kCdr); });
    const bool is_plain = kind == 0 || kind == 1 || kind == 6 || kind == 7;
    EXPECT_EQ(fault,
              is_plain ? "" : fmt::format("has a CDR message of encoding {}; plain ones (0, 1, 6, 7) are read", kind));
  }
  EXPECT_EQ(fault_of_recording([] { (void)MessageCursor(cdr_head(1).substr(0, 3), MessageEncoding::kCdr); }),
            "has a message that ends too early");
}

// A byte, then a number of eight: seven bytes lie between them in version 1, three in version 2, none in ROS 1.
TEST(MessageCursor, ValuesAreAlignedAsTheirEncodingHasIt) {
  const double value = 1234.5678;
  const std::string little = raw(value);
  const std::string big(little.rbegin(), little.rend());
  const auto read = [](const std::string& bytes, MessageEncoding encoding) {
    MessageCursor cursor(bytes, encoding);
    EXPECT_EQ(cursor.whole<std::uint8_t>(), 5);
    return cursor.real();
  };
  const auto gap = [](std::size_t bytes) { return '\5' + std::string(bytes, '\x7f'); };
  EXPECT_EQ(read(cdr_head(0) + gap(7) + big, MessageEncoding::kCdr), value);
  EXPECT_EQ(read(cdr_head(1) + gap(7) + little, MessageEncoding::kCdr), value);
  EXPECT_EQ(read(cdr_head(6) + gap(3) + big, MessageEncoding::kCdr), value);
  EXPECT_EQ(read(cdr_head(7) + gap(3) + little, MessageEncoding::kCdr), value);
  EXPECT_EQ(read(gap(0) + little, MessageEncoding::kRos1), value);
}

TEST(MessageCursor, NothingIsReadBehindTheEnd) {
  const std::string two = raw(std::uint32_t{7}) + raw(std::uint32_t{8});
  MessageCursor cursor(two, MessageEncoding::kRos1);
  EXPECT_EQ(cursor.whole<std::uint32_t>(), 7U);
  EXPECT_EQ(fault_of_recording([&] { (void)cursor.real(); }), "has a message that ends too early");
  EXPECT_EQ(cursor.whole<std::uint32_t>(), 8U) << "to the last byte";
  EXPECT_EQ(fault_of_recording([&] { (void)cursor.whole<std::uint8_t>(); }), "has a message that ends too early");
}

TEST(MessageCursor, ACountOfMoreThanCanBeThereIsRefused) {
  for (const std::uint32_t stated : {0U, 2U, 3U, 4U, 0xffffffffU}) {
    const std::string bytes = raw(stated) + std::string(12, '\1');
    const auto count = [&](std::size_t least_bytes) {
      MessageCursor cursor(bytes, MessageEncoding::kRos1);
      return fault_of_recording([&] { EXPECT_EQ(cursor.count(least_bytes), stated); });
    };
    const std::string refusal = "has a message with fewer values than it states";
    EXPECT_EQ(count(4), stated <= 3 ? "" : refusal) << stated;
    EXPECT_EQ(count(5), stated <= 2 ? "" : refusal) << stated;
  }
}

RecordingChannel channel_of(const std::string& type, MessageEncoding encoding, const std::string& md5 = "") {
  return {.topic = "/t", .type = type, .md5 = md5, .encoding_name = "", .encoding = encoding};
}

TEST(Messages, AreTheirTypesInEncodingsThatAreRead) {
  using Kind = MessageKind;
  const std::vector<std::pair<std::string, Kind>> types{{"sensor_msgs/LaserScan", Kind::kScan},
                                                        {"sensor_msgs/msg/LaserScan", Kind::kScan},
                                                        {"sensor_msgs/MultiEchoLaserScan", Kind::kEchoScan},
                                                        {"nav_msgs/msg/Odometry", Kind::kOdometry},
                                                        {"tf2_msgs/msg/TFMessage", Kind::kTransforms},
                                                        {"tf/tfMessage", Kind::kTransforms},
                                                        {"sensor_msgs/JointState", Kind::kJoints},
                                                        {"std_msgs/Int8", Kind::kNumber},
                                                        {"std_msgs/msg/UInt64", Kind::kNumber},
                                                        {"std_msgs/Float64", Kind::kNumber},
                                                        {"std_msgs/String", Kind::kOther},
                                                        {"other_msgs/Int8", Kind::kOther},
                                                        {"sensor_msgs/LaserScan2", Kind::kOther},
                                                        {"*", Kind::kOther}};
  for (const auto& [type, kind] : types) {
    EXPECT_EQ(message_kind(channel_of(type, MessageEncoding::kCdr)), kind) << type;
    EXPECT_EQ(message_kind(channel_of(type, MessageEncoding::kRos1)), kind) << type;
    EXPECT_EQ(message_kind(channel_of(type, MessageEncoding::kOther)), Kind::kOther) << type;
  }
  // The sum that `rosmsg md5 sensor_msgs/LaserScan` gives.
  EXPECT_EQ(message_kind(channel_of("*", MessageEncoding::kRos1, "90c7ef2dc6895d81024acba2ac42f369")), Kind::kScan);
}

// A laser made in degrees: a step of 0.25 deg is told as the nearest float of it in radians.
TEST(Messages, AnglesOfFewDecimalsOfADegreeAreThoseAngles) {
  for (const double deg : {-135.0, -90.0, 0.5, 0.25, 0.125, 0.3516, 0.0001}) {
    const RosScan scan{.first_rad = static_cast<float>(rad_from_deg(deg)),
                       .step_rad = static_cast<float>(rad_from_deg(deg))};
    const ScanMessage message = read_scan({ros_scan(scan), MessageEncoding::kRos1});
    EXPECT_EQ(message.first_bearing_rad, rad_from_deg(deg)) << deg;
    EXPECT_EQ(message.bearing_step_rad, rad_from_deg(deg)) << deg;
  }
  const float other = 0.0061359233F;  // a turn over 1024: 0.3515625 deg has seven decimals
  EXPECT_EQ(read_scan({ros_scan({.step_rad = other}), MessageEncoding::kRos1}).bearing_step_rad,
            static_cast<double>(other));
}

// One beam has no step, none has no bearing either; for two there must be both.
TEST(Messages, BearingsOfOneBeamAndOfNoneMayBeNoNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto read = [](float first_rad, float step_rad, std::size_t beams) {
    const RosScan scan{.first_rad = first_rad, .step_rad = step_rad, .ranges_m = std::vector<float>(beams, 1.0F)};
    return fault_of_recording([&] {
      const ScanMessage message = read_scan({ros_scan(scan), MessageEncoding::kRos1});
      EXPECT_TRUE(std::isfinite(message.first_bearing_rad) && std::isfinite(message.bearing_step_rad));
    });
  };
  const std::string refusal = "has a scan whose bearings are not finite, or all the same";
  EXPECT_EQ(read(kNan, kNan, 0), "");
  EXPECT_EQ(read(0.5F, kNan, 1), "");
  EXPECT_EQ(read(kNan, 0.1F, 1), refusal);
  EXPECT_EQ(read(0.5F, kNan, 2), refusal);
  EXPECT_EQ(read(kNan, 0.1F, 2), refusal);
  EXPECT_EQ(read(0.5F, 0.0F, 2), refusal);
  EXPECT_EQ(read(0.5F, 0.0F, 1), "");
  EXPECT_EQ(read(0.5F, -0.1F, 2), "");
}

TEST(Messages, AQuaternionOfAnyLengthIsItsRotation) {
  const auto odometry_of = [](double x, double y, double z, double w) {
    return read_odometry({ros_header(1.0, "odom") + sized("base_link") + raw(1.0) + raw(2.0) + raw(3.0) + raw(x) +
                              raw(y) + raw(z) + raw(w),
                          MessageEncoding::kRos1})
        .T_parent_child;
  };
  // A third of a turn about (1, 1, 1) takes x to y, y to z and z to x.
  for (const double length : {0.5, 0.1, 40.0}) {
    const Transform3 T = odometry_of(length, length, length, length);
    const std::array<double, 9> expected{0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(T.rotation[k], expected[k], 1e-15) << length << ' ' << k;
  }
  // An eighth of a turn about each axis in its own plane.
  const double s = std::sin(kPi / 8.0);
  const double c = std::cos(kPi / 8.0);
  const double r = std::sqrt(0.5);
  EXPECT_NEAR(odometry_of(s, 0.0, 0.0, c).rotation[7], r, 1e-15) << "x: y towards z";
  EXPECT_NEAR(odometry_of(0.0, s, 0.0, c).rotation[2], r, 1e-15) << "y: z towards x";
  EXPECT_NEAR(odometry_of(0.0, 0.0, s, c).rotation[3], r, 1e-15) << "z: x towards y";
  EXPECT_EQ(odometry_of(0.0, 0.0, 0.0, 0.0).rotation, Transform3().rotation) << "left out";
  EXPECT_THAT(odometry_of(0.0, 0.0, 0.0, 1.0).shift_m, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(fault_of_recording([&] { (void)odometry_of(0.0, 0.0, 0.0, std::nan("")); }),
            "has a pose that is not finite");
}

TEST(Messages, NumbersKeepTheirSignAndEveryDigit) {
  const auto number = [](const std::string& bytes, const std::string& type) {
    return read_number({bytes, MessageEncoding::kRos1}, type);
  };
  EXPECT_EQ(number(raw(std::int8_t{-3}), "std_msgs/Int8").whole, -3);
  EXPECT_EQ(number(raw(std::uint8_t{253}), "std_msgs/UInt8").whole, 253);
  EXPECT_EQ(number(raw(std::int16_t{-300}), "std_msgs/msg/Int16").whole, -300);
  EXPECT_EQ(number(raw(std::uint16_t{65000}), "std_msgs/UInt16").whole, 65000);
  EXPECT_EQ(number(raw(std::int32_t{-70000}), "std_msgs/Int32").whole, -70000);
  EXPECT_EQ(number(raw(std::uint32_t{4000000000U}), "std_msgs/UInt32").whole, 4000000000);
  EXPECT_EQ(number(raw(std::int64_t{-9007199254740993}), "std_msgs/Int64").whole, -9007199254740993);
  EXPECT_EQ(number(raw(0.1F), "std_msgs/Float32").value, static_cast<double>(0.1F));
  EXPECT_EQ(number(raw(0.1), "std_msgs/Float64").value, 0.1);
  EXPECT_EQ(number(raw(0.1), "std_msgs/Float64").whole, std::nullopt);
}

}  // namespace
}  // namespace gdtslam
