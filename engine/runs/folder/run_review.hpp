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

/// One thing that is doubtful.
struct ReviewNote {
  std::string_view about;  ///< log, run, loops, stretch, loop, scans or wheels; of static storage
  std::string finding;
  std::string advice;
  std::optional<Point2> at_m{};  ///< where that is one place
};

/// A share of scans: "5.4 %", "0.04 %".
std::string percent_text(std::uint64_t part, std::uint64_t whole);

/// Notes on a run, those on the whole map first; empty if there is no doubt. `covariances` has one for each pose, or
/// none if the run has no covariance.csv; the place of a stretch is then its middle.
std::vector<ReviewNote> review_notes(const RunDoubts& doubts, const Trajectory& trajectory,
                                     std::span<const PoseCovariance> covariances);

}  // namespace gdtslam
