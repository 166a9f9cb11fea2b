#include "localize_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

std::string field_file_of(const std::string& map) {
  std::error_code error;
  return std::filesystem::is_directory(map, error) ? (std::filesystem::path(map) / "gdt.yaml").string() : map;
}

// The kernels count in cells of the map's grid, whose origin must lie on it.
FieldView view_of(const DistanceFieldFile& file, const std::string& path) {
  const GridGeometry& grid = file.geometry;
  const double x = grid.origin_x_m / grid.resolution_m;
  const double y = grid.origin_y_m / grid.resolution_m;
  constexpr double kFarthest = 1.0e6;
  if (!(std::fabs(x) < kFarthest && std::fabs(y) < kFarthest)) {
    throw InputError({path, 0}, "the origin lies more than a million cells from the map's; was the file edited?");
  }
  return {.cells = file.cells.data(),
          .width = static_cast<std::uint32_t>(grid.width),
          .height = static_cast<std::uint32_t>(grid.height),
          .stride = static_cast<std::uint32_t>(grid.width),
          .first_cell = {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y))},
          .cap = file.cap,
          .resolution_m = grid.resolution_m};
}

PoseWindow known_window(const DistanceFieldFile& file, const std::string& path) {
  CellBox known{{file.geometry.width, file.geometry.height}, {0, 0}};
  for (std::int32_t y = 0; y < file.geometry.height; ++y) {
    for (std::int32_t x = 0; x < file.geometry.width; ++x) {
      if (file.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(file.geometry.width) +
                     static_cast<std::size_t>(x)] >= file.cap) {
        continue;
      }
      known.min = {std::min(known.min.x, x), std::min(known.min.y, y)};
      known.end = {std::max(known.end.x, x + 1), std::max(known.end.y, y + 1)};
    }
  }
  if (known.empty()) throw InputError({path, 0}, "the map knows no obstacle, so no scan can be found in it");
  const double r = file.geometry.resolution_m;
  return {.centre = {file.geometry.origin_x_m + 0.5 * r * (known.min.x + known.end.x),
                     file.geometry.origin_y_m + 0.5 * r * (known.min.y + known.end.y), 0.0},
          .half_x_m = 0.5 * r * known.width(),
          .half_y_m = 0.5 * r * known.height(),
          .half_theta_rad = kPi};
}

}  // namespace

bool LocalizedScan::is_ambiguous() const {
  return runner_up && runner_up->stop != CertifiedStop::kNothingAllowed && runner_up->bound <= best.cost;
}

Localizer::Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits)
    : config_(config),
      limits_(limits),
      path_(field_file_of(map)),
      file_(read_distance_field(path_)),
      window_(known_window(file_, path_)) {
  try {
    map_.emplace(view_of(file_, path_), make_cpu_backend({})->host_isa());
  } catch (const InputError& error) {
    throw InputError({path_, 0}, error.what());
  }
}

std::optional<LocalizedScan> Localizer::localize(const LaserScan& scan, std::uint64_t index) const {
  const std::vector<PointCells> points = in_cells(points_of(scan, valid_ranges(config_)), file_.geometry.resolution_m);
  if (points.empty() || points.size() < static_cast<std::size_t>(config_.scan.min_points)) return std::nullopt;
  const auto began = std::chrono::steady_clock::now();
  CertifiedOptions options;
  options.gap_m = limits_.gap_m;
  if (limits_.max_seconds) options.max_seconds = *limits_.max_seconds;
  LocalizedScan found{.index = index,
                      .stamp_s = scan.stamp_s,
                      .points = static_cast<std::uint32_t>(points.size()),
                      .wall_s = 0.0,
                      .best = find_pose(*map_, points, window_, options),
                      .runner_up = std::nullopt};
  if (limits_.with_runner_up) {
    options.gap_m = LocalizeLimits::kElsewhereGaps * limits_.gap_m;
    options.max_boxes = LocalizeLimits::kElsewhereBoxes;
    options.excluded = ExcludedPoses{found.best.T_map_base, LocalizeLimits::kElsewhereM, LocalizeLimits::kElsewhereRad};
    found.runner_up = find_pose(*map_, points, window_, options);
  }
  found.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return found;
}

}  // namespace gdtslam
