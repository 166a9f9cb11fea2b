// Contents of a log apart from its records: the kinds of its lines or, in a recording, its topics, frames and clocks,
// and their use for a map. Metres, radians, seconds. Memory is bounded for any length of the log. One log belongs to
// one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// Lines of a text log with the same first word, or rows of a table of the same kind.
struct LineKind {
  std::string name{};
  std::uint64_t count = 0;
  bool is_read = true;
};

/// Counts lines by kind, in the order in which kinds were first met. Their number is bounded, so that a hostile file
/// cannot make the list grow.
class LineCounter {
 public:
  void add(std::string_view kind, bool is_read) {
    for (LineKind& known : list_) {
      if (known.name != kind) continue;
      ++known.count;
      return;
    }
    if (list_.size() < kMostKinds) {
      list_.push_back({std::string(kind), 1, is_read});
    } else {
      if (list_.size() == kMostKinds) list_.push_back({"other kinds", 0, false});
      ++list_.back().count;
    }
  }
  [[nodiscard]] const std::vector<LineKind>& list() const { return list_; }

 private:
  static constexpr std::size_t kMostKinds = 64;
  std::vector<LineKind> list_;
};

/// The use of a topic, or its possible use.
enum class TopicUse : std::uint8_t { kNone, kScans, kOdometry, kFrames, kCrank };

/// The delay from the stamps of messages to their times of receipt: receipt minus stamp. Quantiles of up to 512
/// messages, evenly over the messages read.
struct TopicDelay {
  std::uint64_t messages = 0;  ///< messages with a stamp
  double median_s = 0.0;
  double low_s = 0.0;   ///< a twentieth is below
  double high_s = 0.0;  ///< a twentieth is above
};

/// The least and the largest number in messages of a topic; for joints, the position of the first one.
struct TopicNumbers {
  double least = 0.0;
  double most = 0.0;
};

struct TopicContents {
  std::string name{};
  std::string type{};      ///< pkg/Type
  std::string encoding{};  ///< name in the container
  bool is_readable = true;
  std::uint64_t messages = 0;
  double first_s = 0.0;               ///< receipt of the first message, and of the last one
  double last_s = 0.0;                ///< receipt of the last message
  std::vector<std::string> frames{};  ///< a few frames of the headers
  TopicUse can_be = TopicUse::kNone;
  TopicUse use = TopicUse::kNone;
  std::string why{};  ///< reason for its use or non-use
  std::optional<TopicDelay> delay{};
  std::optional<TopicNumbers> numbers{};
  std::vector<std::string> joints{};  ///< a few names

  /// Messages a second, by their receipt; 0 if that is not known.
  [[nodiscard]] double rate_hz() const {
    return messages > 1 && last_s > first_s ? static_cast<double>(messages - 1) / (last_s - first_s) : 0.0;
  }
};

/// One link of the tree of frames, from the transforms of the recording.
struct FrameLink {
  std::string parent{};
  std::string child{};
  bool is_static = false;  ///< from a topic of transforms that never change
  bool moves = false;      ///< by more than 0.1 mm or 0.1 mrad
  std::uint64_t messages = 0;
  double first_s = 0.0;  ///< receipt of the first transform, and of the last one
  double last_s = 0.0;   ///< receipt of the last transform
  double x_m = 0.0;      ///< the last transform, also below: points of the child in the parent
  double y_m = 0.0;
  double z_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;

  /// Transforms a second, by their receipt; 0 if that is not known.
  [[nodiscard]] double rate_hz() const {
    return messages > 1 && last_s > first_s ? static_cast<double>(messages - 1) / (last_s - first_s) : 0.0;
  }
};

/// Source of a laser's mount on the robot.
enum class MountSource : std::uint8_t { kStated, kFrames, kUnknown };

struct LaserContents {
  std::string topic{};
  std::string frame{};
  MountSource mount = MountSource::kUnknown;
  std::vector<std::string> chain{};  ///< frames from the laser's to the robot's
};

struct LogContents {
  std::string format{};  ///< "ROS 1 bag"
  bool is_recording = false;
  std::vector<LineKind> lines{};        ///< for text logs, in the order of their first lines
  std::vector<TopicContents> topics{};  ///< for recordings, by name
  std::uint64_t topics_left_out = 0;    ///< topics beyond the limit
  std::vector<FrameLink> frames{};      ///< by child
  std::vector<LaserContents> lasers{};  ///< the lasers that are read, by their numbers
  std::string odometry{};               ///< its topic; empty: none
  std::string odometry_why{};           ///< reason for that topic
  std::string odometry_frame{};
  std::string base_frame{};                      ///< the odometry's child
  std::optional<double> odometry_clock_shift{};  ///< added to its stamps; not 0 if clocks differ
  std::optional<double> crank_clock_shift{};     ///< added to the crank's stamps
};

/// A log that describes its contents, as far as it was read.
class DescribedLog : public LogReader {
 public:
  [[nodiscard]] virtual LogContents contents() const = 0;
};

/// open_log() with a description of the contents. With ReadOptions::survey all topics of a recording are examined.
/// Several topics with scans, or none, are then no error: of several, the topic of the first scan is read.
std::unique_ptr<DescribedLog> open_described_log(const std::string& path, const ReadOptions& options);

}  // namespace gdtslam
