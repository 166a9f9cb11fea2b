// Opens a log of any supported kind. The kind is recognised by content, not by name. Memory is bounded by the longest
// line (4 MiB) or message (16 MiB) allowed, for any length of the log. One reader belongs to one thread.
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

/// The formats that open_log() reads, for help and messages before "log" or "logs".
inline constexpr std::string_view kLogFormats = "CARMEN, CSV, JSON lines, ROS bag or MCAP";

/// A laser's place on the robot, by the topic of its scans.
struct TopicMount {
  std::string topic;
  Pose2 T_base_laser;
};

/// Choice of topics of a recording (bag, MCAP).
struct TopicChoice {
  std::vector<std::string> scans{};  ///< topics of scans; "all": all; empty: the only one
  std::string odometry{};            ///< a topic or tf[:FRAME[:BASE]]; empty: the first one, else transforms
  std::string crank{};               ///< topic of a nodding mount's crank, "TOPIC" or "TOPIC:JOINT"; empty: none
  std::vector<TopicMount> mounts{};  ///< other mounts are from the recording's frames
};

/// Thrown at the end of a recording, after all its records, if it lacks a named topic.
class MissingTopic : public UsageError {
 public:
  using UsageError::UsageError;
};

/// Ticks of the crank, or the elevation of the scan plane itself.
enum class CrankKind : std::uint8_t { kTicks, kTilt };

/// The quantity that the crank's messages of a recording count.
struct CrankOptions {
  CrankKind kind = CrankKind::kTicks;
  double step_rad = 0.0;  ///< angle of one unit of the message; 0: one tick, or one radian of a joint
  double zero = 0.0;      ///< the message's value of a level scan plane, in the message's unit
};

/// Options for reading a log. The defaults suit every log that follows docs/formats.md.
struct ReadOptions {
  bool lenient = false;                        ///< count and skip malformed lines instead of throwing
  std::optional<double> first_bearing_rad{};   ///< bearing of beam 0; empty: by the number of beams or the line
  std::optional<double> bearing_step_rad{};    ///< between beams; empty: the same
  std::optional<double> max_range_m{};         ///< the sensor's limit; empty: the log's own
  std::optional<Pose2> T_base_laser{};         ///< the mount; empty: from the two poses of each scan line
  std::optional<double> first_beam_after_s{};  ///< time of beam 0 after the stamp; empty: the log's own
  std::optional<double> beam_period_s{};       ///< from beam to beam; empty: the log's own
  bool deskew = true;                          ///< add the robot's motion to each scan whose beams have different times
  TopicChoice topics{};
  CrankOptions crank{};
  std::optional<double> clock_offset_s{};  ///< for recordings: added to stamps of odometry and crank; measured if empty
  bool all_lasers = false;                 ///< for CARMEN: the second laser too, as ScanRecord::laser 1
  bool survey = false;                     ///< for recordings: look at all topics (log_contents.hpp)
};

/// The wanted part of the logs.
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
/// The same for bytes from any source; `name` is for messages. A ROS 2 bag cannot be read in this way.
std::unique_ptr<LogReader> open_log_of_bytes(ReadBytes read, const std::string& name, const ReadOptions& options);

}  // namespace gdtslam
