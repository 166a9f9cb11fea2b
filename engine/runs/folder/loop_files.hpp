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

/// Finite numbers, separated by blanks, one of the separators, or both; none if the text is anything else.
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

// covariance.csv of a run: the covariance of each pose of trajectory.tum within the map, one row a pose in the same
// order (docs/formats.md). Frame: along the map's axes. Thread-safe; O(rows).

/// A row of the file.
struct StampedCovariance {
  double stamp_s = 0.0;
  PoseCovariance covariance;
};

/// The header and the rows: stamps as in trajectory.tum, all other numbers in the shortest form that reads back as the
/// same bits. Needs one covariance for each pose.
std::string covariance_text(const Trajectory& trajectory, std::span<const PoseCovariance> covariances);

/// Throws InputError with file and line if a row does not have seven numbers, or they are no covariance: not finite, a
/// variance below zero, or a correlation above 1. Throws FileError.
std::vector<StampedCovariance> read_covariances(const std::string& path);

// graph.g2o of a run: the graph in which its loops were closed, as g2o, GTSAM and Ceres' example read it
// (docs/formats.md). Thread-safe; O(relations).

/// One VERTEX_SE2 for each place, numbered as its scan, and one EDGE_SE2 for each relation: first the path, then the
/// loops in the order of the report. The information of a loop is multiplied by its weight, so that plain least squares
/// over all edges has the same optimum; a loop that is switched off has almost no weight. Numbers are in the shortest
/// form that reads back as the same bits. No comments, because not every reader skips them.
std::string graph_text(const ClosedPath& closed);

/// Lines of the file.
struct GraphLines {
  std::vector<GraphPlace> places;
  std::vector<PathRelation> relations;  ///< path and loops; the file does not distinguish them
};

/// The lines as text, unchanged: places, then relations.
std::string graph_lines_text(const GraphLines& graph);

/// Accepts vertices and edges in any order and skips blank lines. Throws InputError with file and line if a line is
/// neither, has a number that is not finite, or has anything after its last number; FileError.
GraphLines read_graph(const std::string& path);

// The report of a path with closed loops: each loop, the errors of the wheels, and the unreliable stretches.
// Thread-safe; linear in scans and loops.

/// A pose with at least this standard deviation is unreliable. On sparse logs 99 % of the poses that are off by 0.3 m
/// exceed it (docs/loops.md).
inline constexpr double kUncertain_m = 0.2;

/// Consecutive scans with unreliable poses.
struct UncertainStretch {
  std::size_t from = 0;  ///< indices into the trajectory, last one included
  std::size_t to = 0;
  double sigma_m = 0.0;  ///< largest standard deviation
};

/// In the order of the path.
std::vector<UncertainStretch> uncertain_stretches(std::span<const PoseCovariance> covariances);

/// One line with their share of the path; empty if there are none.
std::string uncertain_line(std::span<const PoseCovariance> covariances);

nlohmann::ordered_json loops_json(const ClosedPath& closed);
nlohmann::ordered_json wheels_json(const WheelReport& wheels);
/// `trajectory` gives the stamps, one pose for each covariance.
nlohmann::ordered_json uncertain_json(const ClosedPath& closed, const Trajectory& trajectory);

}  // namespace gdtslam
