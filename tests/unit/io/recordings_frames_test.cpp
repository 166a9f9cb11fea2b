// The frames of a recording's transforms: which are odometry, and where the laser sits. Expected values are those of
// the constructed messages.
#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/io/recordings/recording_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::HasSubstr;

// Robots of a fleet have their name before each frame, a camera's odometry has frames of its own, and others name
// frames as they like. Each frame is moved by its own distance, so that the pose says which one was taken.
WholeLog log_of_frames(const std::string& records, const ReadOptions& options) {
  const std::string bytes = mcap_file(records);
  return drain(*open_mcap(source_of(bytes_of(bytes)), "test.mcap", options));
}

TEST(RecordingFrames, OdometryFramesMayHaveANamespaceOrBeNamed) {
  const auto recording = [](const std::vector<std::pair<std::string, std::string>>& odometry,
                            const std::string& laser_frame) {
    std::string data = mcap_channel(1, "/scan", "sensor_msgs/msg/LaserScan", "cdr") +
                       mcap_channel(4, "/tf", "tf2_msgs/msg/TFMessage", "cdr");
    data += mcap_message(4, 0.0, cdr_transform(0.0, "robot1/base_link", "robot1/laser", {.x_m = 0.5}));
    for (int k = 0; k < 4; ++k) {
      double x_m = 0.0;
      for (const auto& [frame, base] : odometry) {
        data += mcap_message(4, k, cdr_transform(k, frame, base, {.x_m = x_m += 1.0}));
      }
      data += mcap_message(1, k, cdr_scan({.stamp_s = 1.0 * k, .frame = laser_frame}));
    }
    return data;
  };
  const std::string first = "robot1/base_link";
  struct Case {
    std::vector<std::pair<std::string, std::string>> odometry;
    std::string laser_frame = "robot1/laser";
    std::string chosen{};
    double x_m = 1.0;
    double mount_x_m = 0.5;
  };
  const std::vector<Case> cases = {
      {.odometry = {{"robot1/odom", first}}},
      {.odometry = {{"robot1/odom", first}}, .laser_frame = "laser"},
      {.odometry = {{"camera_odom_frame", first}}},
      {.odometry = {{"camera_odom_frame", "camera_pose_frame"}, {"robot1/odom", first}}, .x_m = 2.0},
      {.odometry = {{"robot2/odom", "robot2/base_link"}, {"robot1/odom", first}}, .x_m = 2.0},
      {.odometry = {{"robot1/odom", first}, {"world", "robot"}}, .chosen = "tf:world", .x_m = 2.0},
      {.odometry = {{"world", "a"}, {"world", first}}, .chosen = "tf:world:robot1/base_link", .x_m = 2.0}};
  for (const Case& one : cases) {
    ReadOptions options;
    options.topics.odometry = one.chosen;
    const WholeLog log = log_of_frames(recording(one.odometry, one.laser_frame), options);
    const ScanRecord scan = log.of<ScanRecord>().at(2);
    ASSERT_TRUE(scan.T_odom_base.has_value()) << one.odometry.front().first;
    EXPECT_EQ(scan.T_odom_base->x_m, one.x_m) << one.odometry.front().first;
    EXPECT_EQ(scan.scan.T_base_laser.x_m, one.mount_x_m) << one.odometry.front().first;
  }
  const auto refusal = [&](const char* chosen) {
    ReadOptions options;
    options.topics.odometry = chosen;
    return told_by<UsageError>(
        [&] {
          log_of_frames(recording({{"world", "robot"}}, "robot1/laser"), options);
        },
        "no such error");
  };
  EXPECT_THAT(refusal("tf"),
              HasSubstr("no transform from a frame called odom; its transforms are \"robot\" in \"world\""));
  EXPECT_THAT(refusal("tf:map"), HasSubstr("no transform from \"map\"; its transforms are"));
  EXPECT_THAT(refusal("tf:world:none"), HasSubstr("no transform from \"world\" to \"none\""));
}

}  // namespace
}  // namespace gdtslam
