#include "run_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

using PlaceOfScan = std::map<std::size_t, std::size_t>;

[[noreturn]] void refuse(const std::string& folder, const std::string& fault) { throw InputError({folder, 0}, fault); }

Matrix3 to_matrix(const PoseInformation& p) { return {{p.xx, p.xy, p.xt, p.xy, p.yy, p.yt, p.xt, p.yt, p.tt}}; }

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

// Relations of consecutive places are the path's; the others are loops, whose weight is in their information.
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
    const PoseRelation relation{from->second, to->second, line.T_from_to, to_matrix(line.information)};
    if (relation.to == relation.from + 1) {
      session.path.push_back(relation);
    } else {
      session.loops.push_back({relation, 1.0});
    }
  }
}

constexpr float kTooNear_m = 0.001F;  // a range that no run counts; keyframes.bin.gz has no shorter one
constexpr double kLeastMinRange_m = 0.002;

ScanConfig find_widest(const std::vector<RunSession>& runs) {
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
  const ScanConfig widest = find_widest(runs);
  for (RunSession& run : runs) {
    ScanConfig& own = run.settings.mapper.scan;
    for (RunKeyframe& keyframe : run.kept.keyframes) limit_ranges(own, widest, keyframe.laser);
    own.min_range_m = widest.min_range_m;
    own.max_range_m = widest.max_range_m;
  }
}

namespace {

struct OwnedScan {
  const LaserScan* laser = nullptr;
  std::size_t run = 0;
};

bool come_before(const OwnedScan& a, const OwnedScan& b) {
  if (a.laser->stamp_s != b.laser->stamp_s) return a.laser->stamp_s < b.laser->stamp_s;
  if (a.run != b.run) return a.run < b.run;
  return a.laser->ranges_m < b.laser->ranges_m;
}

bool has_return(const LaserScan& laser) {
  return std::any_of(laser.ranges_m.begin(), laser.ranges_m.end(),
                     [](float range_m) { return std::isfinite(range_m); });
}

// Merges and edits turn some readings into no returns; they never change a reading's range, and most readings stay.
bool are_one_scan(const LaserScan& a, const LaserScan& b) {
  if (a.ranges_m.size() != b.ranges_m.size()) return false;
  std::size_t common = 0;
  std::size_t taken_out = 0;
  for (std::size_t beam = 0; beam < a.ranges_m.size(); ++beam) {
    const bool is_in_a = std::isfinite(a.ranges_m[beam]);
    const bool is_in_b = std::isfinite(b.ranges_m[beam]);
    if (is_in_a != is_in_b) ++taken_out;
    if (!is_in_a || !is_in_b) continue;
    if (a.ranges_m[beam] != b.ranges_m[beam]) return false;
    ++common;
  }
  return common > taken_out;
}

// Scans with returns, sorted by stamp and run, without repeated ones.
std::vector<OwnedScan> all_scans(const std::vector<const RunKeyframes*>& runs) {
  std::vector<OwnedScan> scans;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const RunKeyframe& keyframe : runs[run]->keyframes) {
      if (has_return(keyframe.laser)) scans.push_back({&keyframe.laser, run});
    }
  }
  std::sort(scans.begin(), scans.end(), come_before);
  const auto repeats = [](const OwnedScan& a, const OwnedScan& b) { return !come_before(a, b) && !come_before(b, a); };
  scans.erase(std::unique(scans.begin(), scans.end(), repeats), scans.end());
  return scans;
}

using Counts = std::map<std::pair<std::size_t, std::size_t>, std::size_t>;

// For scans with one stamp: counts the scans of a run that a later run also has.
void count_shared(std::span<const OwnedScan> scans, Counts& counts) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    std::size_t last = scans[i].run;
    for (std::size_t k = i + 1; k < scans.size(); ++k) {
      if (scans[k].run == last || !are_one_scan(*scans[i].laser, *scans[k].laser)) continue;
      last = scans[k].run;
      ++counts[{scans[i].run, last}];
    }
  }
}

}  // namespace

std::vector<SharedScans> shared_scans(const std::vector<const RunKeyframes*>& runs) {
  const std::vector<OwnedScan> scans = all_scans(runs);
  Counts counts;
  for (auto begin = scans.begin(); begin != scans.end();) {
    const double stamp_s = begin->laser->stamp_s;
    const auto end = std::find_if(begin, scans.end(), [&](const OwnedScan& s) { return s.laser->stamp_s != stamp_s; });
    count_shared({begin, end}, counts);
    begin = end;
  }
  std::vector<SharedScans> shared;
  shared.reserve(counts.size());
  for (const auto& [pair, count] : counts) shared.push_back({pair.first, pair.second, count});
  return shared;
}

}  // namespace gdtslam
