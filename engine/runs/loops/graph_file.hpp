// graph.g2o of a run: the graph in which its loops were closed, as g2o, GTSAM and Ceres' example read it
// (docs/formats.md). Thread-safe; O(relations).
#pragma once

#include <string>
#include <vector>

#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// A VERTEX_SE2 a place, numbered as its scan, and an EDGE_SE2 a relation: those of the path, then the loops in the
/// order of the report. The information of a loop is multiplied by its weight, so that plain least squares over all
/// edges is what the graph came to; a loop that is switched off counts for next to nothing. Numbers are in the shortest
/// form that reads back as the same bits. No comments: not every reader skips them.
std::string graph_text(const ClosedPath& closed);

/// What the file has, line by line.
struct GraphLines {
  std::vector<GraphPlace> places;
  std::vector<PathRelation> relations;  ///< path and loops, which look alike; who measured them is not said
};

/// The same lines as text: places, then relations, as they are.
std::string graph_lines_text(const GraphLines& graph);

/// Throws InputError with file and line where a line is neither of the two, has a number that is not finite or goes on
/// after its last; FileError. Vertices and edges in any order, blank lines are skipped.
GraphLines read_graph(const std::string& path);

}  // namespace gdtslam
