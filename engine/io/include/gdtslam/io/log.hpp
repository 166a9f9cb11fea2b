// Opens a log of whatever kind it is. Kinds are told apart by content, not by name. Memory is bounded by the longest
// line (4 MiB) or message (16 MiB) allowed, whatever the log's length. One reader belongs to one thread.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// What open_log() reads, as it stands before "log" or "logs" in help and messages.
inline constexpr std::string_view kLogFormats = "CARMEN, CSV, JSON lines or ROS 1 bag";

/// How a log is read. The defaults suit every log whose lines follow docs/formats.md.
struct ReadOptions {
  bool lenient = false;                        ///< count and skip malformed lines instead of throwing
  std::optional<double> first_bearing_rad{};   ///< of beam 0; by the number of beams or by the line when empty
  std::optional<double> bearing_step_rad{};    ///< between beams; likewise
  std::optional<double> max_range_m{};         ///< the sensor's limit; what the log says when empty
  std::optional<Pose2> T_base_laser{};         ///< the mount; from the two poses of each scan line when empty
  std::optional<double> first_beam_after_s{};  ///< when beam 0 was measured, after the stamp; the log's when empty
  std::optional<double> beam_period_s{};       ///< from beam to beam; likewise
  bool deskew =
      true;  ///< tell with each scan how the robot moved meanwhile, where its beams were not all measured at once
  bool all_lasers = false;  ///< of CARMEN: the second laser too, as ScanRecord::laser 1
  std::string topic{};      ///< of a bag: where its scans are; the only one that has any when empty
};

/// Which part of the logs is wanted.
struct ScanRange {
  std::uint64_t skip = 0;  ///< scans to leave out at the start
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();
};

/// A CARMEN text log, a CSV file, JSON lines or a ROS 1 bag, plain or gzip; "-" is standard input. Throws InputError
/// that names what is supported for an MCAP file, a ROS 2 bag or a folder, FileError for what cannot be read.
std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options);

}  // namespace gdtslam
