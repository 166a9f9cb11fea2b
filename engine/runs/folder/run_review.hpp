// What is doubtful in the map of a run, where, and what can be done about it: `gdtslam doctor --after`. Frame: map.
// Thread-safe; linear in poses and loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/folder/run_doubts.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// A stretch that is not to be trusted, and where its least sure pose is.
struct PlacedStretch {
  UncertainStretch scans;
  double from_s = 0.0;
  double to_s = 0.0;
  Point2 at_m = Point2::Zero();
};

/// A loop that was found and is not believed, and where its two scans are.
struct PlacedLoop {
  ClosedLoop loop;
  double from_s = 0.0;
  double to_s = 0.0;
  Point2 from_m = Point2::Zero();
  Point2 to_m = Point2::Zero();
};

/// One thing that is doubtful.
struct ReviewNote {
  std::string_view about;  ///< log, run, loops, stretch, loop, scans or wheels; of static storage
  std::string finding;
  std::string advice;
  std::optional<Point2> at_m{};  ///< where that is one place
};

/// A run with what is to be said of it; nothing is doubtful where there are no notes.
struct RunReview {
  RunDoubts doubts;
  std::vector<PlacedStretch> uncertain;  ///< in the order of the path
  std::vector<PlacedLoop> switched_off;  ///< in the order of the report
  std::vector<ReviewNote> notes;         ///< what concerns the whole map first
  std::uint64_t uncertain_scans = 0;
};

/// A share of scans: "5.4 %", "0.04 %".
std::string percent_text(std::uint64_t part, std::uint64_t whole);

/// `covariances` are one a pose, or none where the run has no covariance.csv: a stretch is then said to be where its
/// middle is.
RunReview review_of(const RunDoubts& doubts, const Trajectory& trajectory, std::span<const PoseCovariance> covariances);

}  // namespace gdtslam
