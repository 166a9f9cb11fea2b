// A line of numbers as text. Thread-safe; linear in the text.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/decimal.hpp"
#include "engine/io/json_file.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// Finite numbers with blanks, one of the separators or both between two; nothing if the text is anything else.
inline std::optional<std::vector<double>> numbers_in(std::string_view text, std::string_view separators) {
  constexpr std::string_view kBlanks = " \t";
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto is_one_of = [&](std::string_view letters) {
    return at != end && letters.find(*at) != std::string_view::npos;
  };
  const auto skip_blanks = [&] {
    while (is_one_of(kBlanks)) ++at;
  };
  for (skip_blanks(); at != end; skip_blanks()) {
    if (!numbers.empty() && is_one_of(separators)) {
      ++at;
      skip_blanks();
    }
    double value = 0.0;
    const char* const stop = parse_double(at, end, value);
    if (stop == nullptr || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    at = stop;
    if (at != end && !is_one_of(kBlanks) && !is_one_of(separators)) return std::nullopt;
  }
  return numbers;
}

// covariance.csv of a run: how sure each pose of trajectory.tum is within the map, one row a pose in the same order
// (docs/formats.md). Frame: along the map's axes. Thread-safe; O(rows).

/// A row of the file.
struct StampedCovariance {
  double stamp_s = 0.0;
  PoseCovariance covariance;
};

/// The header and the rows: stamps as in trajectory.tum, all other numbers in the shortest form that reads back as the
/// same bits. One covariance a pose.
std::string covariance_text(const Trajectory& trajectory, std::span<const PoseCovariance> covariances);

/// Throws InputError with file and line where a row has not seven numbers, or ones that are no covariance: not finite,
/// a variance below zero, or two values that vary together by more than each of them varies; FileError.
std::vector<StampedCovariance> read_covariances(const std::string& path);

// graph.g2o of a run: the graph in which its loops were closed, as g2o, GTSAM and Ceres' example read it
// (docs/formats.md). Thread-safe; O(relations).

/// A VERTEX_SE2 a place, numbered as its scan, and an EDGE_SE2 a relation: those of the path, then the loops in the
/// order of the report. The information of a loop is multiplied by its weight, so that plain least squares over all
/// edges is what the graph came to; a loop that is switched off counts for next to nothing. Numbers are in the shortest
/// form that reads back as the same bits. No comments: not every reader skips them.
std::string graph_text(const ClosedPath& closed);

/// Lines of the file.
struct GraphLines {
  std::vector<GraphPlace> places;
  std::vector<PathRelation> relations;  ///< path and loops, which look alike; who measured them is not said
};

/// The same lines as text: places, then relations, as they are.
std::string graph_lines_text(const GraphLines& graph);

/// Throws InputError with file and line where a line is neither of the two, has a number that is not finite or goes on
/// after its last; FileError. Vertices and edges in any order, blank lines are skipped.
GraphLines read_graph(const std::string& path);

// The report of a path with closed loops: each loop, the errors of the wheels, and the stretches that
// are not to be trusted. Thread-safe; linear in scans and loops.

/// From this standard deviation on a pose is not to be trusted. On sparse logs 99 % of the poses that are off by 0.3 m
/// are beyond it (docs/loops.md).
inline constexpr double kUncertain_m = 0.2;

/// Scans one after the other whose poses are not to be trusted.
struct UncertainStretch {
  std::size_t from = 0;  ///< indices into the trajectory, the last one included
  std::size_t to = 0;
  double sigma_m = 0.0;  ///< the largest of them
};

/// In the order of the path.
std::vector<UncertainStretch> uncertain_stretches(std::span<const PoseCovariance> covariances);

/// One line that says how much of the path they are, or nothing where there are none.
std::string uncertain_line(std::span<const PoseCovariance> covariances);

nlohmann::ordered_json loops_json(const ClosedPath& closed);
nlohmann::ordered_json wheels_json(const WheelReport& wheels);
/// `trajectory` has the stamps; one pose a covariance.
nlohmann::ordered_json uncertain_json(const ClosedPath& closed, const Trajectory& trajectory);

}  // namespace gdtslam
