// What a recording tells of its topics: which are used, and why, by what was asked for and what is there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "engine/io/recordings/recording_reader.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using UseAndWhy = std::pair<TopicUse, std::string>;

std::string two_of(std::uint16_t channel, const std::string& message) {
  return mcap_message(channel, 1.0, message) + mcap_message(channel, 2.0, message);
}

const std::string kTreeType = "tf2_msgs/msg/TFMessage";

/// Two lasers, two odometries, a tree of frames that has odometry too, a crank and what no map needs.
std::string full_recording() {
  const std::string scan = "sensor_msgs/msg/LaserScan";
  const std::string odometry = "nav_msgs/msg/Odometry";
  return mcap_channel(1, "/scan", scan, "cdr") + mcap_channel(2, "/rear", scan, "cdr") +
         mcap_channel(3, "/silent", scan, "cdr") + mcap_channel(4, "/odom", odometry, "cdr") +
         mcap_channel(5, "/fused", odometry, "cdr") + mcap_channel(6, "/tf", kTreeType, "cdr") +
         mcap_channel(7, "/tf_static", kTreeType, "cdr") + mcap_channel(8, "/servo", "std_msgs/msg/Int32", "cdr") +
         mcap_channel(9, "/text", "std_msgs/msg/String", "cdr") + mcap_channel(10, "/odd", scan, "json") +
         two_of(7, cdr_transform(0.0, "base_link", "laser", {.x_m = 0.5})) +
         two_of(6, cdr_transform(1.0, "odom", "base_link", {})) + two_of(4, cdr_odometry(1.0, {})) +
         two_of(5, cdr_odometry(1.0, {})) + two_of(1, cdr_scan({.stamp_s = 1.0})) +
         two_of(2, cdr_scan({.stamp_s = 1.0, .frame = "rear"})) + two_of(8, CdrWriter().put(std::int32_t{7}).bytes()) +
         two_of(9, CdrWriter().text("a").bytes()) + two_of(10, "{}");
}

LogContents contents_of(const std::string& records, ReadOptions options = {}) {
  options.survey = true;
  const std::string bytes = mcap_file(records);
  const auto log = open_mcap(source_of(bytes_of(bytes)), "test.mcap", options);
  (void)drain(*log);
  return log->contents();
}

std::map<std::string, UseAndWhy> uses_of(const LogContents& contents) {
  std::map<std::string, UseAndWhy> uses;
  for (const TopicContents& topic : contents.topics) uses[topic.name] = {topic.use, topic.why};
  return uses;
}

TEST(RecordingUses, WithoutAChoiceTheFirstOfEachKindCounts) {
  const LogContents contents = contents_of(full_recording());
  std::map<std::string, UseAndWhy> uses = uses_of(contents);
  EXPECT_EQ(uses.size(), 10U);
  EXPECT_EQ(uses["/scan"], UseAndWhy(TopicUse::kScans, "read here, but map wants --topic to choose"));
  EXPECT_EQ(uses["/rear"], UseAndWhy(TopicUse::kNone, "map wants --topic to choose"));
  EXPECT_EQ(uses["/silent"], UseAndWhy(TopicUse::kNone, "no messages"));
  EXPECT_EQ(uses["/odom"], UseAndWhy(TopicUse::kOdometry, "the first one with odometry"));
  EXPECT_EQ(uses["/fused"], UseAndWhy(TopicUse::kNone, "another one came first; --odom chooses"));
  EXPECT_EQ(uses["/tf"], UseAndWhy(TopicUse::kFrames, "where lasers sit; its odometry not, --odom tf takes it"));
  EXPECT_EQ(uses["/tf_static"], UseAndWhy(TopicUse::kFrames, "where lasers sit"));
  EXPECT_EQ(uses["/servo"], UseAndWhy(TopicUse::kNone, "--crank takes it, if it tells how the laser nods"));
  EXPECT_EQ(uses["/text"], UseAndWhy(TopicUse::kNone, "a map does not need it"));
  EXPECT_EQ(uses["/odd"], UseAndWhy(TopicUse::kNone, "messages of json are not read"));
  EXPECT_TRUE(contents.is_recording);
  EXPECT_EQ(contents.format, "MCAP");
  EXPECT_EQ(contents.odometry, "/odom");
  EXPECT_EQ(contents.odometry_why, "the first one with odometry");
  EXPECT_EQ(contents.odometry_frame, "odom");
  EXPECT_EQ(contents.base_frame, "base_link");
  EXPECT_EQ(contents.odometry_clock_shift, 0.0);
  ASSERT_EQ(contents.lasers.size(), 1U);
  EXPECT_EQ(contents.lasers[0].topic, "/scan");
  EXPECT_EQ(contents.lasers[0].mount, MountSource::kFrames);
  EXPECT_THAT(contents.lasers[0].chain, ElementsAre("laser", "base_link"));
}

TEST(RecordingUses, WhatWasAskedForIsTold) {
  ReadOptions options;
  options.topics.scans = {"/rear"};
  options.topics.odometry = "/fused";
  options.topics.crank = "/servo";
  options.crank.step_rad = 1.0;
  const LogContents contents = contents_of(full_recording(), options);
  std::map<std::string, UseAndWhy> uses = uses_of(contents);
  EXPECT_EQ(uses["/scan"], UseAndWhy(TopicUse::kNone, "not chosen by --topic"));
  EXPECT_EQ(uses["/rear"], UseAndWhy(TopicUse::kScans, "--topic says so"));
  EXPECT_EQ(uses["/odom"], UseAndWhy(TopicUse::kNone, "not chosen by --odom"));
  EXPECT_EQ(uses["/fused"], UseAndWhy(TopicUse::kOdometry, "--odom says so"));
  EXPECT_EQ(uses["/servo"], UseAndWhy(TopicUse::kCrank, "--crank says so"));
  EXPECT_EQ(contents.odometry, "/fused");
  ASSERT_EQ(contents.lasers.size(), 1U);
  EXPECT_EQ(contents.lasers[0].topic, "/rear");
  EXPECT_EQ(contents.lasers[0].frame, "rear");
  EXPECT_EQ(contents.lasers[0].mount, MountSource::kUnknown);
  EXPECT_THAT(contents.lasers[0].chain, IsEmpty()) << "no transform leads there";
  options.topics.mounts = {{"/rear", Pose2{0.1, 0.2, 0.3}}};
  EXPECT_EQ(contents_of(full_recording(), options).lasers.at(0).mount, MountSource::kStated);
}

// A laser does not nod as wheels turn: no line offers their speeds as its tilt.
TEST(RecordingUses, NumbersOfTheDriveAreNoCrank) {
  const auto number = [](std::uint16_t channel, const std::string& topic) {
    return mcap_channel(channel, topic, "std_msgs/msg/Int32", "cdr") +
           two_of(channel, CdrWriter().put(std::int32_t{7}).bytes());
  };
  const LogContents contents = contents_of(number(1, "/wheel_left") + number(2, "/motor/RPM") + number(3, "/servo") +
                                           number(4, "/base/velocity"));
  for (const TopicContents& topic : contents.topics) {
    const bool is_crank = topic.name == "/servo";
    EXPECT_EQ(topic.can_be, is_crank ? TopicUse::kCrank : TopicUse::kNone) << topic.name;
  }
  ReadOptions options;
  options.topics.crank = "/wheel_left";
  options.crank.step_rad = 1.0;
  EXPECT_EQ(uses_of(contents_of(number(1, "/wheel_left"), options))["/wheel_left"].first, TopicUse::kCrank);
}

}  // namespace
}  // namespace gdtslam
