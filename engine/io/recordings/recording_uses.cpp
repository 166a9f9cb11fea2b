#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/core/one_line.hpp"
#include "recording_survey.hpp"

namespace gdtslam {
namespace {

/// The use of a topic and the reason.
using Reason = std::pair<TopicUse, std::string>;

std::size_t with_scans(const LogContents& contents) {
  return static_cast<std::size_t>(std::count_if(contents.topics.begin(), contents.topics.end(), [](const auto& topic) {
    return topic.can_be == TopicUse::kScans && topic.messages > 0;
  }));
}

Reason scans_reason(const TopicContents& topic, const RecordingUses& uses, const LogContents& contents) {
  if (uses.lasers.contains(topic.name)) {
    if (!uses.choice.scans.empty()) return {TopicUse::kScans, "--topic says so"};
    const bool is_only = with_scans(contents) < 2;
    return {TopicUse::kScans, is_only ? "no other topic has scans" : "read here, but map wants --topic to choose"};
  }
  if (!uses.choice.scans.empty()) return {TopicUse::kNone, "not chosen by --topic"};
  return {TopicUse::kNone, "map wants --topic to choose"};
}

Reason odometry_reason(const TopicContents& topic, const RecordingUses& uses) {
  if (topic.name == uses.odometry) {
    return {TopicUse::kOdometry, uses.choice.odometry.empty() ? "the first one with odometry" : "--odom says so"};
  }
  if (!uses.choice.odometry.empty()) return {TopicUse::kNone, "not chosen by --odom"};
  return {TopicUse::kNone, "another one came first; --odom chooses"};
}

Reason frames_reason(const TopicContents& topic, const RecordingUses& uses, const ScanAssembler& assembler,
                     const LogContents& contents) {
  if (topic.name == uses.odometry) return {TopicUse::kOdometry, "--odom says so"};
  const bool has_odometry = std::any_of(contents.frames.begin(), contents.frames.end(), [](const FrameLink& link) {
    return is_odometry_frame(link.parent) && !link.is_static;
  });
  const bool is_topic = topic.name.ends_with(kTransformTopic);
  const bool is_by_topic = !uses.odometry.empty();
  if (is_topic && has_odometry && !is_by_topic && assembler.has_odometry()) {
    return {TopicUse::kOdometry, "no topic has nav_msgs/Odometry"};
  }
  if (is_topic && has_odometry && is_by_topic) {
    return {TopicUse::kFrames, "where lasers sit; its odometry not, --odom tf takes it"};
  }
  return {TopicUse::kFrames, "where lasers sit"};
}

Reason explain_use(const TopicContents& topic, const RecordingUses& uses, const ScanAssembler& assembler,
                   const LogContents& contents) {
  if (topic.messages == 0) return {TopicUse::kNone, "no messages"};
  switch (topic.can_be) {
    case TopicUse::kScans:
      return scans_reason(topic, uses, contents);
    case TopicUse::kOdometry:
      return odometry_reason(topic, uses);
    case TopicUse::kFrames:
      return frames_reason(topic, uses, assembler, contents);
    case TopicUse::kCrank:
      if (topic.name == uses.crank) return {TopicUse::kCrank, "--crank says so"};
      return {TopicUse::kNone, "--crank takes it, if it tells how the laser nods"};
    case TopicUse::kNone:
      break;
  }
  if (!topic.is_readable)
    return {TopicUse::kNone, fmt::format("messages of {} are not read", one_line(topic.encoding, 20))};
  return {TopicUse::kNone, "a map does not need it"};
}

/// True if a topic's numbers are of the drive, by its name or that of its first joint; then they do not describe a nod.
bool is_of_drive(const TopicContents& topic) {
  constexpr std::array<std::string_view, 8> kWheelWords{"wheel", "vel",   "speed", "rpm",
                                                        "left",  "right", "steer", "throttle"};
  const std::string name = in_small_letters(topic.joints.empty() ? topic.name : topic.joints.front());
  return std::any_of(kWheelWords.begin(), kWheelWords.end(),
                     [&name](std::string_view part) { return name.find(part) != std::string::npos; });
}

}  // namespace

void tell_uses(const RecordingUses& uses, const ScanAssembler& assembler, LogContents& contents) {
  for (TopicContents& topic : contents.topics) {
    if (topic.can_be == TopicUse::kCrank && topic.name != uses.crank && is_of_drive(topic)) {
      topic.can_be = TopicUse::kNone;
    }
    std::tie(topic.use, topic.why) = explain_use(topic, uses, assembler, contents);
    if (topic.use != TopicUse::kOdometry) continue;
    contents.odometry = topic.name;
    contents.odometry_why = topic.why;
  }
  contents.lasers.resize(uses.lasers.size());
  for (const auto& [topic, number] : uses.lasers) {
    contents.lasers[number] = assembler.laser_contents(number);
    contents.lasers[number].topic = topic;
  }
  if (assembler.has_odometry()) {
    contents.odometry_frame = assembler.odometry_frame();
    contents.base_frame = assembler.base_frame();
  }
  contents.odometry_clock_shift = assembler.odometry_shift_s();
  contents.crank_clock_shift = assembler.crank_shift_s();
}

}  // namespace gdtslam
