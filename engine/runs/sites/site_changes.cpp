#include "site_changes.hpp"

#include <fmt/format.h>

#include <limits>

#include "engine/mapping/changes/session_changes.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/changes_of_keyframes.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

std::vector<SiteDrive> drives_of(const std::vector<RunSession*>& runs) {
  std::vector<SiteDrive> drives;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const RunSession& run = *runs[k];
    for (const DriveStretch& stretch : drive_stretches_of({run.kept.keyframes, run.trajectory, run.drives})) {
      drives.push_back({k, run.folder, stretch.first_keyframe, stretch.end_keyframe, stretch.first_s, stretch.last_s});
    }
  }
  return drives;
}

std::vector<DriveViews> views_of(const std::vector<SiteDrive>& drives, const MergedSite& site,
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

ChangesLayer layer_of(const std::vector<ChangedCell>& cells, CellOffset offset) {
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
  SiteChanges changes{.resolution_m = config.map.resolution_m, .drives = drives_of(runs), .by_drive = {}, .last = {}};
  const std::vector<DriveViews> views = views_of(changes.drives, site, runs, counted);
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

Canvas changes_picture_of(const SiteChanges& changes, const OccupancyMap& map, const MergedSite& site,
                          const std::vector<const RunSession*>& runs) {
  const CellOffset offset = cells_from_origin(map.geometry);
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

}  // namespace gdtslam
