#include "site_outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/mapping/changes/session_changes.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

std::vector<SiteDrive> list_drives(const std::vector<RunSession*>& runs) {
  std::vector<SiteDrive> drives;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const RunSession& run = *runs[k];
    for (const DriveStretch& stretch : split_drives({run.kept.keyframes, run.trajectory, run.drives})) {
      drives.push_back({k, run.folder, stretch.first_keyframe, stretch.end_keyframe, stretch.first_s, stretch.last_s});
    }
  }
  return drives;
}

std::vector<DriveViews> count_views(const std::vector<SiteDrive>& drives, const MergedSite& site,
                                    const std::vector<RunSession*>& runs, const ViewCounts::Limits& limits) {
  std::vector<DriveViews> all;
  for (const SiteDrive& drive : drives) {
    all.push_back({ViewCounts(limits), drive.first_s, drive.last_s});
    for (std::size_t i = drive.first_keyframe; i < drive.end_keyframe; ++i) {
      all.back().views.add(runs[drive.run]->kept.keyframes[i].laser, site.poses[drive.run][i]);
    }
  }
  return all;
}

// Turns overruled readings of the scan into no returns; returns their number.
std::size_t take_out(const SessionChanges& found, std::size_t drive, const Pose2& T_site_base, const RayLimits& limits,
                     LaserScan& scan) {
  std::vector<ScanRay> rays;
  collect_rays(scan, T_site_base, beam_directions(scan), limits, rays);
  std::size_t taken = 0;
  for (const ScanRay& ray : rays) {
    if (!ray.is_return || !found.is_overruled(drive, ray.end.cell())) continue;
    scan.ranges_m[ray.beam] = std::numeric_limits<float>::infinity();
    ++taken;
  }
  return taken;
}

ChangesLayer make_layer(const std::vector<ChangedCell>& cells, CellOffset offset) {
  ChangesLayer layer;
  layer.cells.reserve(cells.size());
  for (const ChangedCell& changed : cells) layer.cells.push_back({changed.cell + offset, changed.patch});
  layer.patches = static_cast<std::uint32_t>(count_patches(cells));
  return layer;
}

}  // namespace

SiteChanges take_out_changes(const MergedSite& site, const std::vector<RunSession*>& runs) {
  const ChangeLimits limits;
  const MapperConfig& config = runs.front()->settings.mapper;
  const ViewCounts::Limits counted = change_view_limits(config, limits);
  SiteChanges changes{.resolution_m = config.map.resolution_m, .drives = list_drives(runs), .by_drive = {}, .last = {}};
  const std::vector<DriveViews> views = count_views(changes.drives, site, runs, counted);
  const SessionChanges found(views, changes.resolution_m, limits);
  changes.by_drive = found.by_drive();
  changes.last = found.last();
  if (changes.last.gone.empty()) return changes;
  for (std::size_t k = 0; k < changes.drives.size(); ++k) {
    const SiteDrive& drive = changes.drives[k];
    RunSession& run = *runs[drive.run];
    ScanPoints points(run.settings.mapper.scan);
    for (std::size_t i = drive.first_keyframe; i < drive.end_keyframe; ++i) {
      LaserScan& scan = run.kept.keyframes[i].laser;
      const std::size_t taken = take_out(found, k, site.poses[drive.run][i], counted.rays, scan);
      if (taken > 0) run.session.scans[i] = keep_scan(points.of(scan));
      changes.readings += taken;
    }
  }
  return changes;
}

Canvas draw_changes_picture(const SiteChanges& changes, const OccupancyMap& map, const MergedSite& site,
                            const std::vector<const RunSession*>& runs) {
  const CellOffset offset = cells_from_origin(map.geometry);
  ChangesOverlay overlay{make_layer(changes.last.appeared, offset), make_layer(changes.last.gone, offset), {}};
  for (const SiteDrive& drive : changes.drives) {
    Trajectory path;
    for (std::size_t i = drive.first_keyframe; i < drive.end_keyframe; ++i) {
      path.push_back({runs[drive.run]->kept.keyframes[i].laser.stamp_s, site.poses[drive.run][i]});
    }
    overlay.drives.push_back(std::move(path));
  }
  MapLook look;
  look.title = "What changed between the drives";
  look.subtitle = fmt::format("{} drives; what is gone is not in the map, and what is new is", changes.drives.size());
  return changes_picture(map, overlay, look, size_for_content(map.geometry.width, map.geometry.height));
}

nlohmann::ordered_json changes_json(const SiteChanges& changes) {
  const auto cells_json = [&](const std::vector<ChangedCell>& cells) {
    return nlohmann::ordered_json{
        {"places", count_patches(cells)},
        {"cells", cells.size()},
        {"area_m2", changes.resolution_m * changes.resolution_m * static_cast<double>(cells.size())}};
  };
  nlohmann::ordered_json drives = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < changes.drives.size(); ++k) {
    drives.push_back({{"run", changes.drives[k].folder},
                      {"first_stamp_s", changes.drives[k].first_s},
                      {"last_stamp_s", changes.drives[k].last_s},
                      {"new", cells_json(changes.by_drive[k].appeared)},
                      {"gone", cells_json(changes.by_drive[k].gone)}});
  }
  return {{"drives", std::move(drives)},
          {"new", cells_json(changes.last.appeared)},
          {"gone", cells_json(changes.last.gone)},
          {"readings_taken_out", changes.readings}};
}

namespace {

constexpr std::size_t kMostMatched = 4000;  // limit on points of a keyframe
constexpr std::array kDoubts{Doubt::kFewPoints, Doubt::kLowOverlap, Doubt::kContradiction, Doubt::kWeakEvidence,
                             Doubt::kFarFromPrediction};

PoseInformation to_information(const Matrix3& m) {
  return {.xx = m(0, 0), .xy = m(0, 1), .xt = m(0, 2), .yy = m(1, 1), .yt = m(1, 2), .tt = m(2, 2)};
}

PoseCovariance to_covariance(const Matrix3& m) {
  return {.xx = m(0, 0), .xy = m(0, 1), .xt = m(0, 2), .yy = m(1, 1), .yt = m(1, 2), .tt = m(2, 2)};
}

// Adds the doubtful scans of a run's report with their indices in the site.
void add_doubtful(const ReportReader& report, const RunSession& run, std::size_t before,
                  std::vector<DoubtfulScan>& doubtful) {
  for (const ReportReader& entry : report.entries("doubtful_scans")) {
    const std::string reason = entry.text("reason");
    const auto* const doubt =
        std::find_if(kDoubts.begin(), kDoubts.end(), [&](Doubt d) { return to_string(d) == reason; });
    doubtful.push_back({.index = before + entry.index("index", run.trajectory.size()),
                        .stamp_s = entry.number("stamp_s"),
                        .reason = doubt == kDoubts.end() ? Doubt::kWeakEvidence : *doubt,
                        .accepted = entry.truth("accepted"),
                        .from_prediction_m = entry.number("from_prediction_m"),
                        .from_prediction_rad = rad_from_deg(entry.number("from_prediction_deg"))});
  }
}

void add_counts(const ReportReader& report, const RunSession& run, MapperStatistics& sum) {
  sum.scans += run.trajectory.size();
  sum.matched += report.whole("matched");
  sum.doubtful += report.whole("doubtful");
  sum.keyframes += run.kept.keyframes.size();
  sum.restarts += report.whole("restarts");
}

// Sum over the drives of the time from first to last stamp; the days between do not count.
double sum_durations_s(const Trajectory& path, const std::vector<std::size_t>& drives) {
  double duration_s = 0.0;
  for (std::size_t k = 0; k <= drives.size(); ++k) {
    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(k == 0 ? 0 : drives[k - 1]);
    const auto end = k == drives.size() ? path.end() : path.begin() + static_cast<std::ptrdiff_t>(drives[k]);
    const auto [first, last] =
        std::minmax_element(begin, end, [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
    if (first != end) duration_s += last->stamp_s - first->stamp_s;
  }
  return duration_s;
}

// The graph of the site; its nodes have the numbers of the scans.
ClosedPath closed_path(const MergedSite& site, const std::vector<std::size_t>& keyframes, MapOutcome& outcome) {
  ClosedPath closed;
  closed.is_closed = true;
  closed.keyframes = keyframes;
  closed.searches = site.searches;
  closed.pairs = site.joint.pairs;
  closed.rms_m = site.joint.rms_m;
  const auto scan_of = [&](std::size_t place) { return keyframes[site.places[place]]; };
  for (std::size_t i = 0; i < site.places.size(); ++i) closed.places.push_back({scan_of(i), site.graph.poses[i]});
  for (const PoseRelation& relation : site.graph.path) {
    closed.path.push_back({.from = scan_of(relation.from),
                           .to = scan_of(relation.to),
                           .T_from_to = relation.T_from_to,
                           .information = to_information(relation.information)});
  }
  for (const Loop& loop : site.graph.loops) {
    const PoseRelation& relation = loop.relation;
    const Tangent2 off = relation_residual(relation, site.graph.poses[relation.from], site.graph.poses[relation.to]);
    closed.loops.push_back({.from = scan_of(relation.from),
                            .to = scan_of(relation.to),
                            .T_from_to = relation.T_from_to,
                            .information = to_information(relation.information),
                            .weight = loop.weight,
                            .off_m = std::sqrt(square(off[0]) + square(off[1])),
                            .off_rad = std::fabs(off[2]),
                            .is_on = loop.is_on()});
  }
  closed.covariances.reserve(outcome.trajectory.size());
  std::size_t keyframe = 0;
  for (std::size_t scan = 0; scan < outcome.trajectory.size(); ++scan) {
    while (keyframe + 1 < keyframes.size() && keyframes[keyframe + 1] <= scan) ++keyframe;
    closed.covariances.push_back(to_covariance(site.covariances[keyframe]));
  }
  return closed;
}

}  // namespace

Trajectory trajectory_in_site(const RunSession& run, const std::vector<Pose2>& keyframes) {
  const std::vector<RunKeyframe>& kept = run.kept.keyframes;
  const auto moved_by = [&](std::size_t keyframe, const Pose2& pose) {
    return keyframes[keyframe] * between(kept[keyframe].T_map_base, pose);
  };
  Trajectory path = run.trajectory;
  std::size_t last = 0;
  for (std::size_t scan = 0; scan < path.size(); ++scan) {
    while (last + 1 < kept.size() && kept[last + 1].scan <= scan) ++last;
    const Pose2 pose = path[scan].T_map_base;
    path[scan].T_map_base = moved_by(last, pose);
    if (last + 1 == kept.size() || scan <= kept[last].scan) continue;
    const double share =
        static_cast<double>(scan - kept[last].scan) / static_cast<double>(kept[last + 1].scan - kept[last].scan);
    const Tangent2 off = log_tangent(between(path[scan].T_map_base, moved_by(last + 1, pose)));
    path[scan].T_map_base = path[scan].T_map_base * exp_tangent({share * off[0], share * off[1], share * off[2]});
  }
  return path;
}

MapOutcome site_outcome(const MergedSite& site, const std::vector<const RunSession*>& runs,
                        const std::vector<Trajectory>& paths) {
  MapOutcome outcome;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const std::size_t before = outcome.trajectory.size();
    if (before > 0) outcome.drives.push_back(before);
    outcome.trajectory.insert(outcome.trajectory.end(), paths[k].begin(), paths[k].end());
    for (const RunKeyframe& keyframe : runs[k]->kept.keyframes) {
      outcome.keyframes.push_back(before + keyframe.scan);
      outcome.keyframe_scans.push_back(keyframe.laser);
    }
    const ReportReader report = runs[k]->files.report();
    add_doubtful(report, *runs[k], before, outcome.doubtful);
    add_counts(report, *runs[k], outcome.statistics);
    for (const std::size_t drive : runs[k]->drives) outcome.drives.push_back(before + drive);
    outcome.statistics.path_m += path_length_m(paths[k], runs[k]->drives);
    outcome.log_duration_s += sum_durations_s(paths[k], runs[k]->drives);
  }
  outcome.closed = closed_path(site, outcome.keyframes, outcome);
  return outcome;
}

std::vector<double> distances_from(const GlobalField& field, const std::vector<const RunSession*>& runs,
                                   const std::vector<std::vector<Pose2>>& poses) {
  std::vector<double> distances_m;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const MapperConfig& config = runs[k]->settings.mapper;
    ScanPoints scan_points(config.scan);
    for (std::size_t i = 0; i < poses[k].size(); ++i) {
      std::vector<PointCells> points =
          in_cells(scan_points.of(runs[k]->kept.keyframes[i].laser), field.geometry().resolution_m);
      if (points.empty()) continue;
      if (points.size() > kMostMatched) points.resize(kMostMatched);
      distances_m.push_back(mean_distances_m(field, points, {poses[k][i], poses[k][i]}, config.map.truncation_m)[0]);
    }
  }
  return distances_m;
}

}  // namespace gdtslam
