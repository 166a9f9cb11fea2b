// Opens a log of any supported kind. The kind is recognised by content, not by name. Memory is bounded by the longest
// line (4 MiB) or message (16 MiB) allowed, whatever the log's length. One reader belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// The formats that open_log() reads, as they stand before "log" or "logs" in help and messages.
inline constexpr std::string_view kLogFormats = "CARMEN, CSV, JSON lines, ROS bag or MCAP";

/// A laser's place on the robot, by the topic of its scans.
struct TopicMount {
  std::string topic;
  Pose2 T_base_laser;
};

/// Which topics of a recording (bag, MCAP) are read.
struct TopicChoice {
  std::vector<std::string> scans{};  ///< the only one that has any when empty; "all" are all of them
  std::string odometry{};            ///< a topic or tf[:FRAME[:BASE]]; the first one, then transforms, when empty
  std::string crank{};               ///< topic of a nodding mount's crank, "TOPIC" or "TOPIC:JOINT"; none when empty
  std::vector<TopicMount> mounts{};  ///< the frames of the recording give the others
};

/// At the end of a recording: a topic that was named is not in it. All that is there was given before.
class MissingTopic : public UsageError {
 public:
  using UsageError::UsageError;
};

/// Ticks of the crank, or the elevation of the scan plane itself.
enum class CrankKind : std::uint8_t { kTicks, kTilt };

/// The quantity that the crank's messages of a recording count.
struct CrankOptions {
  CrankKind kind = CrankKind::kTicks;
  double step_rad = 0.0;  ///< one unit of the message; 0: one tick, or one radian of a joint
  double zero = 0.0;      ///< the message's value of a level scan plane, in the message's unit
};

/// How a log is read. The defaults suit every log whose lines follow docs/formats.md.
struct ReadOptions {
  bool lenient = false;                        ///< count and skip malformed lines instead of throwing
  std::optional<double> first_bearing_rad{};   ///< bearing of beam 0; by the number of beams or by the line when empty
  std::optional<double> bearing_step_rad{};    ///< between beams; likewise
  std::optional<double> max_range_m{};         ///< the sensor's limit; if empty, the log's own
  std::optional<Pose2> T_base_laser{};         ///< the mount; from the two poses of each scan line when empty
  std::optional<double> first_beam_after_s{};  ///< when beam 0 was measured, after the stamp; the log's when empty
  std::optional<double> beam_period_s{};       ///< from beam to beam; likewise
  bool deskew =
      true;  ///< add to each scan the motion of the robot while it was taken, if its beams have different times
  TopicChoice topics{};
  CrankOptions crank{};
  std::optional<double> clock_offset_s{};  ///< for recordings: added to stamps of odometry and crank; measured if empty
  bool all_lasers = false;                 ///< for CARMEN: the second laser too, as ScanRecord::laser 1
  bool survey = false;                     ///< for recordings: look at all that is there (log_contents.hpp)
};

/// Which part of the logs is wanted.
struct ScanRange {
  std::uint64_t skip = 0;  ///< scans to leave out at the start
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();
};

/// A CARMEN text log, a CSV file, JSON lines, a ROS 1 bag or an MCAP file, plain or packed, or a ROS 2 bag; "-" is
/// standard input. Throws InputError, which names the supported kinds, for anything else; FileError for a file that
/// cannot be read; UsageError if topics are chosen for a log that has none.
std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options);

/// Fills at most the target and returns the number of bytes. Waits if no data is there yet; returns 0 only at the end.
/// May throw FileError, InputError.
using ReadBytes = std::function<std::size_t(std::span<char> target)>;
/// The same of bytes that come from anywhere; `name` stands in messages. A ROS 2 bag cannot be read that way.
std::unique_ptr<LogReader> open_log_of_bytes(ReadBytes read, const std::string& name, const ReadOptions& options);

}  // namespace gdtslam
