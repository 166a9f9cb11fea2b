// Table 2 of the paper: the log mapped from end to end with each matcher, and how far its poses are from the truth, a
// reference trajectory or verified relations [Kuemmerle2009]. Cost: a whole `gdtslam map` for each matcher.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "run.hpp"

namespace gdtslam {

/// What a whole run is held against; at most one of both.
struct CompareTruth {
  std::optional<Trajectory> reference;
  std::string reference_file;
  std::vector<Relation> relations;
  std::string relations_file;
  [[nodiscard]] bool is_given() const { return reference.has_value() || !relations.empty(); }
};

struct WholeRun {
  std::string method;
  ErrorSummary position_m;
  ErrorSummary heading_deg;
  double cpu_s = 0.0;        ///< inside the mapper, all threads
  double time_ratio = 0.0;   ///< over simplex; 0 where simplex was not run
  double evaluations = 0.0;  ///< a scan
  std::uint64_t scans = 0;
  std::uint64_t doubtful = 0;
};

/// Methods that are no matcher of `map` are left out. Throws as compare() does, InputError where the truth belongs to
/// another log.
std::vector<WholeRun> whole_runs(const CompareJob& job, const CompareTruth& truth, Backend& backend,
                                 const std::function<CompareProgress(const std::string&)>& progress_of,
                                 const std::function<bool()>& stop);

}  // namespace gdtslam
