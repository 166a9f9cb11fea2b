// The graph of a run that closed loops, put together from graph.g2o and report.json. Frame: map. Thread-safe; linear in
// places and relations.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/runs/folder/run_reader.hpp"

namespace gdtslam {

struct RunGraph {
  /// The places' poses as the graph came to, what was measured along the path, by the front end before the wheels, and
  /// the loops with what each was worth by itself and its weight; indices are places.
  PoseGraph graph;
  std::vector<std::size_t> scans;  ///< for each place, ascending: an index into the trajectory
  std::vector<bool> is_on;         ///< for each loop, as the report has it
};

/// Throws InputError where the run has no graph, is a site of several drives, or its graph is not of one run with its
/// report: other scans, a step of the path that is missing, other loops; FileError.
RunGraph read_run_graph(const RunReader& run);

}  // namespace gdtslam
