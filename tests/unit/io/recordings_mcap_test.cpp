// MCAP files: those of other writers (tests/fixtures/recordings), and our own with every kind of damage.
#include <gmock/gmock.h>

#include "engine/io/recordings/recording_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> kForeignFiles{"ros2_zstd", "ros2_lz4", "ros2_plain", "ros2_unchunked", "ros1_zstd"};

std::string foreign_mcap(const std::string& name) {
  return get_file(std::string(GDTSLAM_SOURCE_DIR) + "/tests/fixtures/recordings/" + name + ".mcap");
}

WholeLog drained_mcap(const std::string& bytes, const ReadOptions& options = {}) {
  return drain(*open_mcap(source_of(bytes_of(bytes)), "test.mcap", options));
}

template <class Failure>
std::string mcap_refusal(const std::string& bytes, const ReadOptions& options = {}) {
  return told_by<Failure>([&] { drained_mcap(bytes, options); }, "no such error");
}

// The values are those of make_mcap.mjs: 0.5 m/s along x, odometry a quarter of a second beside each scan.
TEST(Mcap, FilesOfOtherWritersAreReadAsTheyWereMade) {
  for (const std::string& name : kForeignFiles) {
    const WholeLog log = drained_mcap(foreign_mcap(name));
    const auto scans = log.of<ScanRecord>();
    ASSERT_EQ(scans.size(), 5U) << name;
    EXPECT_TRUE(log.warnings.empty()) << name << ": " << log.warnings.front().first;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      const LaserScan& scan = scans[k].scan;
      const auto n = static_cast<float>(k);
      EXPECT_DOUBLE_EQ(scan.stamp_s, 100.5 + 0.5 * static_cast<double>(k)) << name;
      EXPECT_THAT(scan.ranges_m, ElementsAre(1.0F + n, 2.0F + n, 3.0F + n, 4.0F + n, 5.0F + n));
      EXPECT_EQ(scan.first_bearing_rad, -1.0);
      EXPECT_EQ(scan.bearing_step_rad, 0.5);
      EXPECT_EQ(scan.max_range_m, 30.0);
      EXPECT_EQ(scan.beam_period_s, 0.0078125);
      EXPECT_EQ(scan.first_beam_after_s, 0.0);
      EXPECT_EQ(scan.T_base_laser.x_m, 0.25);
      ASSERT_TRUE(scans[k].T_odom_base.has_value()) << name;
      EXPECT_NEAR(scans[k].T_odom_base->x_m, 0.25 * static_cast<double>(k + 1), 1e-9) << name;
    }
  }
}

/// Scans at 1, 2, 3 s between odometry every second; a channel that nobody reads between them.
std::string mcap_drive(bool is_cdr) {
  const std::string encoding = is_cdr ? "cdr" : "ros1";
  const std::string middle = is_cdr ? "/msg/" : "/";
  std::string data = mcap_channel(7, "/scan", "sensor_msgs" + middle + "LaserScan", encoding);
  data += mcap_channel(2, "/odom", "nav_msgs" + middle + "Odometry", encoding);
  data += mcap_channel(3, "/camera", "sensor_msgs" + middle + "Image", encoding);
  for (int k = 0; k < 5; ++k) {
    const double stamp_s = k;
    const RosPose pose{.x_m = 2.0 * stamp_s, .yaw_rad = 0.125 * stamp_s};
    data += mcap_message(2, stamp_s, is_cdr ? cdr_odometry(stamp_s, pose) : ros_odometry(stamp_s, pose));
    data += mcap_message(3, stamp_s, std::string(300, 'x'));
    if (k == 0 || k == 4) continue;
    const RosScan scan{.stamp_s = stamp_s, .frame = k == 1 ? "laser" : "laser2"};  // names of several alignments
    data += mcap_message(7, stamp_s, is_cdr ? cdr_scan(scan) : ros_scan(scan));
  }
  return data;
}

TEST(Mcap, EncodingsAndPackingsChangeNothing) {
  const WholeLog plain = drained_mcap(mcap_file(mcap_drive(false)));
  const auto expected = plain.of<ScanRecord>();
  ASSERT_EQ(expected.size(), 3U);
  EXPECT_EQ(expected[1].T_odom_base->x_m, 4.0);
  EXPECT_NEAR(expected[1].T_odom_base->theta_rad, 0.25, 1e-12);
  for (const bool is_cdr : {false, true}) {
    for (const std::string packing : {"", "lz4", "zstd"}) {
      const auto scans = drained_mcap(gzip(mcap_file(mcap_chunk(mcap_drive(is_cdr), packing)))).of<ScanRecord>();
      ASSERT_EQ(scans.size(), 3U) << packing << is_cdr;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(scans[k].scan.stamp_s, expected[k].scan.stamp_s);
        EXPECT_EQ(scans[k].scan.ranges_m, expected[k].scan.ranges_m);
        EXPECT_EQ(scans[k].T_odom_base->x_m, expected[k].T_odom_base->x_m);
        EXPECT_EQ(scans[k].T_odom_base->theta_rad, expected[k].T_odom_base->theta_rad);
      }
    }
  }
}

TEST(Mcap, BigEndianMessagesAreReadAndOtherEncodingsNamed) {
  const std::string channel = mcap_channel(1, "/scan", "sensor_msgs/msg/LaserScan", "cdr");
  const std::string big = mcap_file(channel + mcap_message(1, 5.0, cdr_scan({.stamp_s = 5.0}, true)));
  EXPECT_THAT(drained_mcap(big).of<ScanRecord>().at(0).scan.ranges_m, ElementsAre(1.0F, 2.0F, 3.0F));
  std::string odd = cdr_scan({.stamp_s = 5.0});
  odd[1] = 3;  // a list of parameters
  EXPECT_THAT(mcap_refusal<InputError>(mcap_file(channel + mcap_message(1, 5.0, odd))), HasSubstr("encoding 3"));
  const std::string foreign = mcap_channel(1, "/points", "foxglove.LaserScan", "protobuf") + mcap_message(1, 5.0, "x");
  const std::string refused = mcap_refusal<InputError>(mcap_file(foreign));
  EXPECT_THAT(refused, HasSubstr("/points (foxglove.LaserScan as protobuf, which is not read, 1)"));
}

TEST(McapDamage, SumsOfChunksAndOfTheFileAreChecked) {
  const std::string good = mcap_chunk(mcap_drive(true), "zstd");
  const std::string drive = mcap_drive(true);
  const std::string bad = mcap_chunk(drive, "", {.bytes = drive.size(), .crc = crc_of(drive) ^ 1U});
  EXPECT_THAT(mcap_refusal<InputError>(mcap_file(good + bad)), HasSubstr("CRC"));
  const WholeLog log = drained_mcap(mcap_file(good + bad + good), {.lenient = true});
  EXPECT_EQ(log.warned("damaged recording"), 1U);
  const std::size_t scans = drained_mcap(mcap_file(good)).of<ScanRecord>().size();
  EXPECT_LE(log.of<ScanRecord>().size(), 2 * scans) << "the sum of a chunk is checked at its end";
  EXPECT_GE(log.of<ScanRecord>().size(), scans);
  std::string foreign = foreign_mcap("ros2_unchunked");
  const std::size_t at = foreign.find("laser");
  ASSERT_NE(at, std::string::npos);
  foreign[at] = 'L';
  EXPECT_THAT(mcap_refusal<InputError>(foreign), HasSubstr("CRC of its data"));
}

TEST(McapDamage, NoNumberOfTheFileIsAllocated) {
  const std::string huge = raw(std::uint64_t{1} << 60U);
  const std::string channel = mcap_channel(1, "/scan", "sensor_msgs/msg/LaserScan", "cdr");
  const std::string message = "\5" + huge + raw(std::uint16_t{1}) + std::string(40, '\0');
  for (const std::string& bytes :
       {mcap_head() + channel + message, mcap_head() + "\3" + huge + "abc", mcap_head() + "\4" + huge + "abc",
        mcap_head() + "\6" + huge + std::string(60, '\1'), mcap_head() + mcap_record('\6', std::string(50, '\xff')),
        mcap_head() + mcap_record('\4', std::string(50, '\xff')), mcap_file(mcap_record('\5', "short"))}) {
    EXPECT_NE(mcap_refusal<InputError>(bytes), "no such error");
  }
  EXPECT_THAT(mcap_refusal<InputError>("\x89MCAP1\r\nrest"), HasSubstr("version 0"));
  EXPECT_THAT(mcap_refusal<InputError>(mcap_file(mcap_chunk(channel, "brotli"))), HasSubstr("zstd"));
}

TEST(McapDamage, AChunkUnpacksToNoMoreThanItStates) {
  const std::string zeros(std::size_t{200} << 20U, '\0');
  for (const std::uint64_t stated : {std::uint64_t{100}, std::uint64_t{1} << 40U}) {
    const std::string bomb = mcap_file(mcap_chunk(zeros, "zstd", {.bytes = stated, .crc = 0}));
    EXPECT_LT(bomb.size(), 100'000U);
    EXPECT_THAT(mcap_refusal<InputError>(bomb), HasSubstr("chunk"));
  }
}

}  // namespace
}  // namespace gdtslam
