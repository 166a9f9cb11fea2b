// What the trials of `gdtslam compare` add up to: for each method and each kind of start the errors, the share of
// successes and of proven optima with their confidence, evaluations and times. Thread-safe; O(n log n).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/runs/evaluation/share.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "run.hpp"

namespace gdtslam {

struct MethodFigures {
  std::string method;
  ErrorSummary distance_m;
  ErrorSummary x_m;
  ErrorSummary y_m;
  ErrorSummary theta_deg;
  Share success;
  Share optimal;  ///< of all trials; what the certificate does not cover is no optimum
  ErrorSummary evaluations;
  ErrorSummary seconds;
  double time_ratio = 0.0;  ///< mean time over that of simplex; 0 where simplex was not run
};

/// Which scans count.
enum class ScanKind : std::uint8_t {
  kHeld,       ///< solution proven, held in every direction
  kWeak,       ///< proven, weak along a corridor
  kUncertain,  ///< not proven within the limit
};
ScanKind kind_of(const CompareScan& scan);
std::uint64_t count_of(const CompareOutcome& outcome, ScanKind kind);

/// The figures of one level of starts (0: the prediction) on scans of a kind, in the order of the methods.
std::vector<MethodFigures> figures_of(const CompareJob& job, const CompareOutcome& outcome, std::uint32_t level,
                                      ScanKind kind);

/// The distances (m) that one method's trials ended from the solution, in the order of the trials.
std::vector<double> distances_of(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                 ScanKind kind);

}  // namespace gdtslam
