#include "run_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/loops/graph_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

using PlaceOfScan = std::map<std::size_t, std::size_t>;

[[noreturn]] void refuse(const std::string& folder, const std::string& fault) { throw InputError({folder, 0}, fault); }

Matrix3 matrix_of(const PoseInformation& p) { return {{p.xx, p.xy, p.xt, p.xy, p.yy, p.yt, p.xt, p.yt, p.tt}}; }

void take_keyframes(const RunKeyframes& kept, const MapperConfig& config, const std::vector<std::size_t>& drives,
                    Session& session) {
  ScanPoints points(config.scan);
  double path_m = 0.0;
  auto drive = drives.begin();
  for (const RunKeyframe& keyframe : kept.keyframes) {
    if (!session.poses.empty()) path_m += translation_length(between(session.poses.back(), keyframe.T_map_base));
    for (; drive != drives.end() && keyframe.scan >= *drive; ++drive) path_m += kBetweenDrives_m;
    session.scans.push_back(keep_scan(points.of(keyframe.laser)));
    session.poses.push_back(keyframe.T_map_base);
    session.path_m.push_back(path_m);
  }
}

// Relations of places that follow each other are the path's, the others are loops, whose weight is in their
// information.
void take_graph(const RunReader& run, const RunKeyframes& kept, Session& session) {
  const std::string file = run.files().path("graph.g2o");
  const GraphLines graph = run.graph();
  PlaceOfScan place_of;
  std::size_t keyframe = 0;
  for (const GraphPlace& place : graph.places) {
    while (keyframe < kept.keyframes.size() && kept.keyframes[keyframe].scan < place.scan) ++keyframe;
    if (keyframe == kept.keyframes.size() || kept.keyframes[keyframe].scan != place.scan) {
      refuse(file, "has a place at scan " + std::to_string(place.scan) +
                       ", which is no keyframe of keyframes.bin.gz: map the log again");
    }
    place_of[place.scan] = session.places.size();
    session.places.push_back(keyframe);
  }
  if (session.places.empty() || session.places.front() != 0) {
    refuse(file, "has no place at the first keyframe: map the log again");
  }
  for (const PathRelation& line : graph.relations) {
    const auto from = place_of.find(line.from);
    const auto to = place_of.find(line.to);
    if (from == place_of.end() || to == place_of.end()) refuse(file, "has an edge of a place that it does not have");
    const PoseRelation relation{from->second, to->second, line.T_from_to, matrix_of(line.information)};
    if (relation.to == relation.from + 1) {
      session.path.push_back(relation);
    } else {
      session.loops.push_back({relation, 1.0});
    }
  }
}

constexpr float kTooNear_m = 0.001F;  // a range that no run counts; keyframes.bin.gz has none that is shorter
constexpr double kLeastMinRange_m = 0.002;

ScanConfig widest_of(const std::vector<RunSession>& runs) {
  ScanConfig widest = runs.front().settings.mapper.scan;
  bool is_one = true;
  for (const RunSession& run : runs) {
    const ScanConfig& own = run.settings.mapper.scan;
    is_one = is_one && own.min_range_m == widest.min_range_m;
    widest.min_range_m = std::min(widest.min_range_m, own.min_range_m);
    widest.max_range_m = std::max(widest.max_range_m, own.max_range_m);
  }
  if (!is_one) widest.min_range_m = std::max(widest.min_range_m, kLeastMinRange_m);
  return widest;
}

void limit_ranges(const ScanConfig& own, const ScanConfig& widest, LaserScan& laser) {
  if (own.max_range_m < widest.max_range_m) {
    laser.max_range_m = laser.max_range_m > 0.0 ? std::min(laser.max_range_m, own.max_range_m) : own.max_range_m;
  }
  if (own.min_range_m <= widest.min_range_m) return;
  for (float& range_m : laser.ranges_m) {
    if (static_cast<double>(range_m) < own.min_range_m) range_m = kTooNear_m;
  }
}

}  // namespace

RunSession read_run_session(const std::string& folder) {
  const RunReader reader(folder);
  if (reader.summary().nods) refuse(folder, "is a run of a laser that nods; only flat lasers' runs can be joined");
  if (!reader.summary().has_loops) {
    refuse(folder, "was mapped with --no-loops, so nothing holds its path: map its log again without it");
  }
  std::optional<RunKeyframes> kept = reader.keyframes();
  if (!kept) refuse(folder, "has no keyframes.bin.gz, which older versions did not write: map its log again");
  RunSession run{.folder = folder,
                 .name = reader.name(),
                 .keyframes_sha256 = *reader.summary().keyframes_sha256,
                 .settings = reader.settings(),
                 .trajectory = reader.trajectory(),
                 .drives = reader.summary().drives,
                 .kept = std::move(*kept),
                 .session = {},
                 .files = reader.files()};
  take_keyframes(run.kept, run.settings.mapper, run.drives, run.session);
  if (std::all_of(run.session.scans.begin(), run.session.scans.end(),
                  [](const KeptScan& s) { return s.points() == 0; })) {
    refuse(folder,
           "has no keyframe with a return, so nothing tells where it belongs: name the run that it was made from");
  }
  take_graph(reader, run.kept, run.session);
  run.session.doubts = doubts_by_path(run.session);
  return run;
}

void share_range_limits(std::vector<RunSession>& runs) {
  const ScanConfig widest = widest_of(runs);
  for (RunSession& run : runs) {
    ScanConfig& own = run.settings.mapper.scan;
    for (RunKeyframe& keyframe : run.kept.keyframes) limit_ranges(own, widest, keyframe.laser);
    own.min_range_m = widest.min_range_m;
    own.max_range_m = widest.max_range_m;
  }
}

}  // namespace gdtslam
