// What `gdtslam live` prints: a line for each scan, flushed, for whoever steers by it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

inline constexpr std::array<std::string_view, 2> kPoseLineFormats{"json", "tum"};

class PoseLines {
 public:
  /// One of kPoseLineFormats.
  explicit PoseLines(std::string_view format) : is_json_(format == kPoseLineFormats[0]) {}
  /// Throws FileError where standard output cannot be written; a reader that is gone is none of its concern.
  void print(std::uint64_t scan, const MatchResult& match, const Pose2& T_closed_front) const;

 private:
  bool is_json_;
};

}  // namespace gdtslam
