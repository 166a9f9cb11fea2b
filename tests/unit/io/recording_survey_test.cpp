// What is told of the topics and frames of a recording: counts, rates, delays, and how much of it at most.
#include "engine/io/recordings/recording_survey.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bag_writer.hpp"
#include "engine/io/recordings/topics.hpp"
#include "engine/io/recordings/transform3.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;

RecordingChannel told_channel(const std::string& topic, const std::string& type) {
  return {.topic = topic, .type = type, .md5 = "", .encoding_name = "ros1", .encoding = MessageEncoding::kRos1};
}

/// A survey of one topic, fed with messages of ROS 1.
struct SurveyOf {
  SurveyOf(const std::string& topic, const std::string& type)
      : channel{.definition = told_channel(topic, type), .kind = message_kind(told_channel(topic, type))} {
    survey.add_channel(channel.definition);
  }
  void add(const std::string& message, double received_s) {
    survey.add(channel, {.bytes = message, .encoding = MessageEncoding::kRos1}, received_s);
  }
  [[nodiscard]] TopicContents topic() const { return survey.contents().topics.at(0); }
  TopicChannel channel;
  RecordingSurvey survey;
};

TEST(RecordingSurvey, CountsMessagesAndTellsTheirTimesAndDelays) {
  SurveyOf scans("/scan", "sensor_msgs/LaserScan");
  for (int k = 0; k <= 20; ++k) scans.add(ros_scan({.stamp_s = 1.0 + k}), 1.0 + k + 0.25 * k);
  scans.add(ros_scan({.stamp_s = 0.0}), 100.0);  // without a stamp, so without a delay
  const TopicContents topic = scans.topic();
  EXPECT_EQ(topic.can_be, TopicUse::kScans);
  EXPECT_EQ(topic.messages, 22U);
  EXPECT_EQ(topic.first_s, 1.0);
  EXPECT_EQ(topic.last_s, 100.0);
  EXPECT_NEAR(topic.rate_hz(), 21.0 / 99.0, 1e-12);
  ASSERT_TRUE(topic.delay);
  EXPECT_EQ(topic.delay->messages, 21U);
  EXPECT_NEAR(topic.delay->low_s, 0.25, 1e-12) << "of 0, 0.25, ... 5 s";
  EXPECT_NEAR(topic.delay->median_s, 2.5, 1e-12);
  EXPECT_NEAR(topic.delay->high_s, 4.75, 1e-12);
  EXPECT_THAT(topic.frames, ElementsAre("laser"));
}

// Of each use 256 topics are kept, the others are counted.
TEST(RecordingSurvey, KeepsSomeTopicsOfEachUse) {
  RecordingSurvey survey;
  for (int k = 0; k < 258; ++k) survey.add_channel(told_channel(fmt::format("/p{}", k), "sensor_msgs/Image"));
  for (int k = 0; k < 256; ++k) survey.add_channel(told_channel(fmt::format("/s{}", k), "sensor_msgs/LaserScan"));
  survey.add_channel(told_channel("/s7", "sensor_msgs/LaserScan"));
  EXPECT_EQ(survey.contents().topics.size(), 512U);
  EXPECT_EQ(survey.contents().topics_left_out, 2U);
  survey.add_channel(told_channel("/one_more", "sensor_msgs/LaserScan"));
  EXPECT_EQ(survey.contents().topics_left_out, 3U);
}

FrameLink link_after(const std::string& topic, const std::vector<RosPose>& poses) {
  SurveyOf frames(topic, "tf2_msgs/TFMessage");
  double time_s = 1.0;
  for (const RosPose& pose : poses) {
    frames.add(ros_transform(time_s, "base", "laser", pose), time_s);
    time_s += 1.0;
  }
  return frames.survey.contents().frames.at(0);
}

// log_contents.hpp: a frame moves by more than 0.1 mm or 0.1 mrad.
TEST(RecordingSurvey, AFrameMovesByMoreThanATenthOfAMillimetre) {
  EXPECT_FALSE(link_after("/tf", {{.x_m = 1.0}, {.x_m = 1.00009}}).moves);
  EXPECT_TRUE(link_after("/tf", {{.x_m = 1.0}, {.x_m = 1.00011}}).moves);
  EXPECT_TRUE(link_after("/tf", {{.x_m = 1.0}, {.x_m = 0.99989}}).moves);
  EXPECT_FALSE(link_after("/tf", {{}, {.yaw_rad = 0.00009}}).moves);
  EXPECT_TRUE(link_after("/tf", {{}, {.yaw_rad = 0.00011}}).moves);
  EXPECT_TRUE(link_after("/tf", {{.x_m = 1.0}, {.x_m = 1.1}, {.x_m = 1.0}}).moves) << "and back";
  const FrameLink link = link_after("/tf", {{.x_m = 1.0}, {.x_m = 1.00006}, {.x_m = 1.00012}});
  EXPECT_TRUE(link.moves) << "since the first";
  EXPECT_EQ(link.messages, 3U);
  EXPECT_EQ(link.first_s, 1.0);
  EXPECT_EQ(link.last_s, 3.0);
  EXPECT_EQ(link.rate_hz(), 1.0);
  EXPECT_FALSE(link.is_static);
}

// A chain of frames is followed over 32 steps, because it may be a ring.
TEST(FrameTree, FollowsAChainOf31Links) {
  for (const int links : {30, 31, 32}) {
    FrameTree tree;
    for (int k = 0; k < links; ++k) {
      tree.add(k == 0 ? "base_link" : fmt::format("f{}", k), fmt::format("f{}", k + 1), {.shift_m = {1.0, 0.0, 0.0}});
    }
    const std::string laser = fmt::format("f{}", links);
    EXPECT_EQ(tree.chain(laser, "").size(), links < 32 ? static_cast<std::size_t>(links + 1) : 0U);
    ASSERT_EQ(tree.find(laser, "").has_value(), links < 32);
    if (links < 32) {
      EXPECT_EQ(tree.find(laser, "")->shift_m[0], links);
    }
  }
}

TEST(FrameTree, KnowsRobotsBasesAndKeeps4096Frames) {
  FrameTree tree;
  for (const char* const base : {"base_link", "base_footprint", "base", "robot"}) {
    tree.add(base, std::string("laser_on_") + base, {});
    EXPECT_EQ(tree.find(std::string("laser_on_") + base, "").has_value(), base != std::string("robot"));
    EXPECT_TRUE(tree.find(std::string("laser_on_") + base, base));
  }
  for (int k = 4; k < 4096; ++k) tree.add("base", fmt::format("f{}", k), {});
  tree.add("base", "one_more", {});
  EXPECT_TRUE(tree.find("f4095", ""));
  EXPECT_FALSE(tree.find("one_more", ""));
  tree.add("robot", "f4095", {});
  EXPECT_FALSE(tree.find("f4095", "")) << "who is known may still move";
}

}  // namespace
}  // namespace gdtslam
