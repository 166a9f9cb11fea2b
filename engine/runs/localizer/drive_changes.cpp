#include "drive_changes.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"

namespace gdtslam {
namespace {

ViewCounts::Limits limits_of_views(const OccupancyMap& map, const ScanConfig& scan, const ChangeLimits& limits,
                                   std::uint64_t max_cells) {
  return {.rays = {.resolution_m = map.geometry.resolution_m,
                   .min_range_m = scan.min_range_m,
                   .max_range_m = scan.max_range_m,
                   .short_of_end_m = limits.tolerance_m},
          .spacing_m = limits.spacing_m,
          .max_cells = max_cells};
}

void add_rows(const GridGeometry& grid, const std::vector<ChangedCell>& cells, const char* change, std::string& text) {
  for (const ChangedCell& changed : cells) {
    const Point2 at_m = grid.centre_of(changed.cell);
    text += fmt::format("{:.4f},{:.4f},{},{},{},{}\n", at_m.x(), at_m.y(), change, changed.patch + 1,
                        changed.views.ends, changed.views.passes);
  }
}

}  // namespace

OccupancyMap cells_of_map(const MapField& field) {
  if (field.source == MapField::Source::kOccupiedCells) return read_occupancy_map(field.path);
  const std::filesystem::path file = std::filesystem::path(field.path).parent_path() / "map.yaml";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    throw InputError({field.path, 0},
                     "has no map.yaml beside it, which says what is free: changes cannot be told; map the log again "
                     "without --no-map");
  }
  return read_occupancy_map(file.string());
}

DriveChanges::DriveChanges(OccupancyMap map, const ScanConfig& scan, const ChangeLimits& limits,
                           std::uint64_t max_cells)
    : map_(std::move(map)), limits_(limits), views_(limits_of_views(map_, scan, limits, max_cells)) {}

void DriveChanges::see(const LaserScan& scan, const TrackedPose& pose) {
  const bool is_sure = pose.whereabouts == Whereabouts::kTracked && !pose.is_ambiguous;
  if (is_sure) {
    if (!is_seeing_) stretches_.emplace_back();
    stretches_.back().push_back({scan.stamp_s, pose.T_map_base});
    Pose2 T_grid_base = pose.T_map_base;
    T_grid_base.x_m -= map_.geometry.origin_x_m;
    T_grid_base.y_m -= map_.geometry.origin_y_m;
    views_.add(scan, T_grid_base);
  }
  is_seeing_ = is_sure;
}

std::string changes_table(const GridGeometry& grid, const MapChanges& changes) {
  std::string text = "x_m,y_m,change,place,ended,passed\n";
  add_rows(grid, changes.appeared, "new", text);
  add_rows(grid, changes.gone, "gone", text);
  return text;
}

}  // namespace gdtslam
