#include "site_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/mapping/changes/session_changes.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

std::vector<SiteDrive> drives_of(const std::vector<RunSession*>& runs) {
  std::vector<SiteDrive> drives;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const RunSession& run = *runs[k];
    std::vector<std::size_t> starts{0};
    starts.insert(starts.end(), run.drives.begin(), run.drives.end());
    std::size_t keyframe = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : run.trajectory.size();
      SiteDrive drive{.run = k, .folder = run.folder, .first_keyframe = keyframe};
      while (keyframe < run.kept.keyframes.size() && run.kept.keyframes[keyframe].scan < end) ++keyframe;
      drive.end_keyframe = keyframe;
      drive.first_s = std::numeric_limits<double>::infinity();
      drive.last_s = -drive.first_s;
      for (std::size_t scan = starts[i]; scan < end; ++scan) {
        drive.first_s = std::min(drive.first_s, run.trajectory[scan].stamp_s);
        drive.last_s = std::max(drive.last_s, run.trajectory[scan].stamp_s);
      }
      drives.push_back(drive);
    }
  }
  return drives;
}

RayLimits rays_of(const MapperConfig& config, const ChangeLimits& limits) {
  return {.resolution_m = config.map.resolution_m,
          .min_range_m = config.scan.min_range_m,
          .max_range_m = config.scan.max_range_m,
          .short_of_end_m = limits.tolerance_m};
}

std::vector<DriveViews> views_of(const std::vector<SiteDrive>& drives, const MergedSite& site,
                                 const std::vector<RunSession*>& runs, const RayLimits& rays,
                                 const ChangeLimits& limits) {
  const std::uint64_t max_cells = static_cast<std::uint64_t>(runs.front()->settings.mapper.map.max_megacells) << 20U;
  std::vector<DriveViews> all;
  for (const SiteDrive& drive : drives) {
    all.push_back({ViewCounts({.rays = rays, .spacing_m = limits.spacing_m, .max_cells = max_cells}), drive.first_s,
                   drive.last_s});
    for (std::size_t i = drive.first_keyframe; i < drive.end_keyframe; ++i) {
      all.back().views.add(runs[drive.run]->kept.keyframes[i].laser, site.poses[drive.run][i]);
    }
  }
  return all;
}

// Its beams become such without return; says how many.
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

CellOffset cells_to_origin(const OccupancyMap& map) {
  const auto whole = [&map](double origin_m) {
    return static_cast<std::int32_t>(std::lround(origin_m / map.geometry.resolution_m));
  };
  return {-whole(map.geometry.origin_x_m), -whole(map.geometry.origin_y_m)};
}

void mark(const std::vector<ChangedCell>& cells, CellState state, OccupancyMap& map) {
  const CellOffset offset = cells_to_origin(map);
  for (const ChangedCell& changed : cells) {
    const CellIndex cell = changed.cell + offset;
    if (!map.geometry.contains(cell)) continue;
    map.cells.set(static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(map.geometry.width) +
                      static_cast<std::size_t>(cell.x),
                  state);
  }
}

ChangesLayer layer_of(const std::vector<ChangedCell>& cells, CellOffset offset) {
  ChangesLayer layer;
  layer.cells.reserve(cells.size());
  for (const ChangedCell& changed : cells) layer.cells.push_back({changed.cell + offset, changed.patch});
  layer.patches = static_cast<std::uint32_t>(patches_of(cells));
  return layer;
}

}  // namespace

SiteChanges take_out_changes(const MergedSite& site, const std::vector<RunSession*>& runs) {
  const ChangeLimits limits;
  const MapperConfig& config = runs.front()->settings.mapper;
  const RayLimits rays = rays_of(config, limits);
  SiteChanges changes{.resolution_m = config.map.resolution_m, .drives = drives_of(runs), .by_drive = {}, .last = {}};
  const std::vector<DriveViews> views = views_of(changes.drives, site, runs, rays, limits);
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
      const std::size_t taken = take_out(found, k, site.poses[drive.run][i], rays, scan);
      if (taken > 0) run.session.scans[i] = keep_scan(points.of(scan));
      changes.readings += taken;
    }
  }
  return changes;
}

void mark_changes(const SiteChanges& changes, OccupancyMap& map) {
  mark(changes.last.gone, CellState::kFree, map);
  mark(changes.last.appeared, CellState::kOccupied, map);
}

Canvas changes_picture_of(const SiteChanges& changes, const OccupancyMap& map, const MergedSite& site,
                          const std::vector<const RunSession*>& runs) {
  const CellOffset offset = cells_to_origin(map);
  ChangesOverlay overlay{layer_of(changes.last.appeared, offset), layer_of(changes.last.gone, offset), {}};
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
        {"places", patches_of(cells)},
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

}  // namespace gdtslam
