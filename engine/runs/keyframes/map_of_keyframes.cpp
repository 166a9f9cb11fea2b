#include "map_of_keyframes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "engine/mapping/changes/session_changes.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// A run that closes loops keeps its points as floats until the end.
void round_to_floats(std::vector<Point2>& points) {
  for (Point2& point : points) point = point.cast<float>().cast<double>();
}

}  // namespace

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config) {
  auto map = std::make_unique<SeparateMap>(config);
  ScanPoints scan_points(config.scan);
  for (const std::size_t k : which) {
    const RunKeyframe& keyframe = run.keyframes[k];
    std::vector<Point2> points = scan_points.of(keyframe.laser);
    if (run.in_single_precision) round_to_floats(points);
    map->merge(points, keyframe.T_map_base);
  }
  return map;
}

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config) {
  std::vector<std::size_t> all(run.keyframes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return map_of_keyframes(run, all, config);
}

namespace {

void mark_cells(const std::vector<ChangedCell>& cells, CellState state, OccupancyMap& map) {
  const CellOffset offset = cells_from_origin(map.geometry);
  for (const ChangedCell& changed : cells) {
    const CellIndex cell = changed.cell + offset;
    if (!map.geometry.contains(cell)) continue;
    map.cells.set(static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(map.geometry.width) +
                      static_cast<std::size_t>(cell.x),
                  state);
  }
}

}  // namespace

std::vector<DriveStretch> split_drives(const DrivenKeyframes& run) {
  std::vector<std::size_t> starts{0};
  starts.insert(starts.end(), run.drives.begin(), run.drives.end());
  std::vector<DriveStretch> stretches;
  std::size_t keyframe = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : run.trajectory.size();
    DriveStretch stretch{.first_keyframe = keyframe};
    while (keyframe < run.keyframes.size() && run.keyframes[keyframe].scan < end) ++keyframe;
    stretch.end_keyframe = keyframe;
    stretch.first_s = std::numeric_limits<double>::infinity();
    stretch.last_s = -stretch.first_s;
    for (std::size_t scan = starts[i]; scan < end; ++scan) {
      stretch.first_s = std::min(stretch.first_s, run.trajectory[scan].stamp_s);
      stretch.last_s = std::max(stretch.last_s, run.trajectory[scan].stamp_s);
    }
    stretches.push_back(stretch);
  }
  return stretches;
}

ViewCounts::Limits change_view_limits(const MapperConfig& config, const ChangeLimits& limits) {
  return {.rays = {.resolution_m = config.map.resolution_m,
                   .min_range_m = config.scan.min_range_m,
                   .max_range_m = config.scan.max_range_m,
                   .short_of_end_m = limits.tolerance_m},
          .spacing_m = limits.spacing_m,
          .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U};
}

MapChanges changes_after_all(const DrivenKeyframes& run, const MapperConfig& config) {
  if (run.drives.empty()) return {};
  const ChangeLimits limits;
  std::vector<DriveViews> all;
  for (const DriveStretch& stretch : split_drives(run)) {
    all.push_back({ViewCounts(change_view_limits(config, limits)), stretch.first_s, stretch.last_s});
    for (std::size_t i = stretch.first_keyframe; i < stretch.end_keyframe; ++i) {
      all.back().views.add(run.keyframes[i].laser, run.keyframes[i].T_map_base);
    }
  }
  return SessionChanges(all, config.map.resolution_m, limits).last();
}

void mark_changes(const MapChanges& after_all, OccupancyMap& map) {
  mark_cells(after_all.gone, CellState::kFree, map);
  mark_cells(after_all.appeared, CellState::kOccupied, map);
}

CellOffset cells_from_origin(const GridGeometry& map) {
  const auto whole = [&map](double origin_m) {
    return static_cast<std::int32_t>(std::lround(origin_m / map.resolution_m));
  };
  return {-whole(map.origin_x_m), -whole(map.origin_y_m)};
}

}  // namespace gdtslam
