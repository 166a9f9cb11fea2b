#include "run_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/loops/loop_files.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// Which file of which run is read: for messages.
struct GraphOfRun {
  std::string file;
  std::string folder;
  [[noreturn]] void refuse(const std::string& fault) const {
    throw InputError({file, 0}, fmt::format("{}: not of one run{}{}", fault, kMapAgain, folder));
  }
};

Matrix3 to_matrix(const PoseInformation& i, double factor) {
  return factor * Matrix3{{i.xx, i.xy, i.xt, i.xy, i.yy, i.yt, i.xt, i.yt, i.tt}};
}

std::size_t place_of_scan(const std::vector<std::size_t>& scans, std::size_t scan, const GraphOfRun& source) {
  const auto found = std::lower_bound(scans.begin(), scans.end(), scan);
  if (found == scans.end() || *found != scan)
    source.refuse(fmt::format("has an edge of scan {}, but no such vertex", scan));
  return static_cast<std::size_t>(found - scans.begin());
}

PoseRelation relation_of_line(const PathRelation& line, double factor, const std::vector<std::size_t>& scans,
                              const GraphOfRun& source) {
  return {.from = place_of_scan(scans, line.from, source),
          .to = place_of_scan(scans, line.to, source),
          .T_from_to = line.T_from_to,
          .information = to_matrix(line.information, factor)};
}

void check_path(const PoseGraph& graph, const GraphOfRun& source) {
  std::vector<bool> is_known(graph.poses.size(), false);
  for (const PoseRelation& step : graph.path) {
    if (step.to != step.from + 1)
      source.refuse("has an edge that is neither a step of the path nor a loop of the report");
    is_known[step.from] = true;
  }
  if (std::find(is_known.begin(), is_known.end() - 1, false) != is_known.end() - 1) {
    source.refuse("has no edge from one of its places to the next");
  }
}

std::vector<std::size_t> scans_of_places(const GraphLines& lines, const RunReader& run, const GraphOfRun& source) {
  std::vector<std::size_t> scans;
  scans.reserve(lines.places.size());
  for (const GraphPlace& place : lines.places) {
    if (place.scan >= run.summary().scans || (!scans.empty() && place.scan <= scans.back())) {
      source.refuse(
          fmt::format("has vertex {} of {} scans, or not in the order of the path", place.scan, run.summary().scans));
    }
    scans.push_back(place.scan);
  }
  return scans;
}

}  // namespace

RunGraph read_run_graph(const RunReader& run) {
  const GraphOfRun source{(std::filesystem::path(run.folder()) / "graph.g2o").string(), run.folder()};
  if (!run.files().has("graph.g2o")) {
    throw InputError({source.file, 0}, fmt::format("is missing in this run{}{}", kMapAgain, source.folder));
  }
  if (!run.summary().drives.empty()) {
    throw InputError({source.file, 0}, "is of a site, whose drives do not make up one path");
  }
  const std::vector<ClosedLoop> told = run.doubts().loops.value_or(LoopFindings()).loops;
  const GraphLines lines = run.graph();
  if (lines.places.empty()) source.refuse("has no places");
  if (lines.relations.size() < told.size()) source.refuse("has fewer edges than the report has loops");
  RunGraph result;
  result.scans = scans_of_places(lines, run, source);
  result.graph.poses.reserve(lines.places.size());
  for (const GraphPlace& place : lines.places) result.graph.poses.push_back(place.T_map_base);
  const std::size_t steps = lines.relations.size() - told.size();
  result.graph.path.reserve(steps);
  result.graph.loops.reserve(told.size());
  result.is_on.reserve(told.size());
  for (std::size_t i = 0; i < lines.relations.size(); ++i) {
    const PathRelation& line = lines.relations[i];
    if (i < steps) {
      result.graph.path.push_back(relation_of_line(line, 1.0, result.scans, source));
      continue;
    }
    const ClosedLoop& loop = told[i - steps];
    if (line.from != loop.from || line.to != loop.to) {
      source.refuse(fmt::format("has an edge from scan {} to {} where the report has a loop from {} to {}", line.from,
                                line.to, loop.from, loop.to));
    }
    const double by_itself = loop.weight > 0.0 ? 1.0 / loop.weight : 0.0;
    result.graph.loops.push_back({relation_of_line(line, by_itself, result.scans, source), loop.weight});
    result.is_on.push_back(loop.is_on);
  }
  check_path(result.graph, source);
  return result;
}

}  // namespace gdtslam
