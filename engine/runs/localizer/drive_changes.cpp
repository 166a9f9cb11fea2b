#include "drive_changes.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"

namespace gdtslam {
namespace {

// Which cells of the map that the field belongs to are free and occupied.
OccupancyMap read_cells(const MapField& field) {
  if (field.source == MapField::Source::kOccupiedCells) return read_occupancy_map(field.path);
  if (field.run && field.run->summary().map) return field.run->map();
  const std::filesystem::path file = std::filesystem::path(field.path).parent_path() / "map.yaml";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    throw InputError({field.path, 0},
                     "has no map.yaml beside it, which says what is free: changes cannot be told; map the log again "
                     "without --no-map");
  }
  return read_occupancy_map(file.string());
}

ViewCounts views_in(const OccupancyMap& map, const MapperConfig& config, const ChangeLimits& limits) {
  return ViewCounts({.rays = {.resolution_m = map.geometry.resolution_m,
                              .min_range_m = config.scan.min_range_m,
                              .max_range_m = config.scan.max_range_m,
                              .short_of_end_m = limits.tolerance_m},
                     .spacing_m = limits.spacing_m,
                     .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U});
}

void add_rows(const GridGeometry& grid, const std::vector<ChangedCell>& cells, const char* change, std::string& text) {
  for (const ChangedCell& changed : cells) {
    const Point2 at_m = grid.centre_of(changed.cell);
    text += fmt::format("{:.4f},{:.4f},{},{},{},{}\n", at_m.x(), at_m.y(), change, changed.patch + 1,
                        changed.views.ends, changed.views.passes);
  }
}

}  // namespace

DriveChanges::DriveChanges(const MapField& field, const MapperConfig& config, const ChangeLimits& limits)
    : map_(read_cells(field)), limits_(limits), views_(views_in(map_, config, limits)) {
  see_what_was_before(field, config);
}

void DriveChanges::see_what_was_before(const MapField& field, const MapperConfig& config) {
  const std::optional<std::string> folder = find_run_folder(field.path);
  if (field.source == MapField::Source::kOccupiedCells || !folder) return;
  const std::optional<RunKeyframes> kept = (field.run ? *field.run : RunReader(*folder)).keyframes();
  if (!kept) return;
  before_.emplace(views_in(map_, config, limits_));
  for (const RunKeyframe& keyframe : kept->keyframes) before_->add(keyframe.laser, in_grid(keyframe.T_map_base));
}

Pose2 DriveChanges::in_grid(const Pose2& T_map_base) const {
  return {T_map_base.x_m - map_.geometry.origin_x_m, T_map_base.y_m - map_.geometry.origin_y_m, T_map_base.theta_rad};
}

void DriveChanges::see(const LaserScan& scan, const TrackedPose& pose) {
  const bool is_sure = pose.whereabouts == Whereabouts::kTracked && !pose.is_ambiguous;
  if (is_sure) {
    if (!is_seeing_) stretches_.emplace_back();
    stretches_.back().push_back({scan.stamp_s, pose.T_map_base});
    views_.add(scan, in_grid(pose.T_map_base));
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
