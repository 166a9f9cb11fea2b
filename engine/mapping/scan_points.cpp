#include "gdtslam/mapping/scan_points.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/elementary.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kFurthestPointCell = 1 << 28;
constexpr std::int32_t kMostWindowCells = 32767;  // largest side: the limit of the transforms' kernels

std::int32_t cell_floor(double cells) {
  return static_cast<std::int32_t>(std::floor(std::clamp(cells, -kFurthestPointCell, kFurthestPointCell)));
}

}  // namespace

std::vector<Point2> to_points(const LaserScan& scan, const ScanConfig& valid) { return ScanPoints(valid).of(scan); }

void ScanPoints::update_directions(const LaserScan& scan) {
  if (directions_.size() == scan.ranges_m.size() && first_bearing_rad_ == scan.first_bearing_rad &&
      bearing_step_rad_ == scan.bearing_step_rad) {
    return;
  }
  first_bearing_rad_ = scan.first_bearing_rad;
  bearing_step_rad_ = scan.bearing_step_rad;
  directions_.clear();
  directions_.reserve(scan.ranges_m.size());
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto direction = beam_direction(scan, beam);
    directions_.emplace_back(direction.cos, direction.sin);
  }
}

std::vector<Point2> ScanPoints::of(const LaserScan& scan) {
  update_directions(scan);
  const double limit = range_limit_m(scan, valid_.max_range_m);
  const bool moved = is_skewed(scan);
  const Pose2& mount = scan.T_base_laser;
  const auto turned = sin_cos(mount.theta_rad);
  std::vector<Point2> points;
  points.reserve(scan.ranges_m.size());
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range = static_cast<double>(scan.ranges_m[beam]);
    if (!(range >= valid_.min_range_m && range < limit)) continue;  // false for NaN too
    const Point2 seen = range * directions_[beam];
    const Point2 point = moved ? laser_at_beam(scan, beam) * seen
                               : Point2(mount.x_m + (turned.cos * seen.x() - turned.sin * seen.y()),
                                        mount.y_m + (turned.sin * seen.x() + turned.cos * seen.y()));
    if (point.allFinite() && point.cwiseAbs().maxCoeff() < kFurthestFromRobot_m) points.push_back(point);
  }
  return points;
}

std::vector<PointCells> in_cells(const std::vector<Point2>& points_m, double resolution_m) {
  std::vector<PointCells> cells;
  cells.reserve(points_m.size());
  for (const Point2& p : points_m) {
    cells.push_back({static_cast<float>(p.x() / resolution_m), static_cast<float>(p.y() / resolution_m)});
  }
  return cells;
}

std::vector<Point2> in_map(const std::vector<Point2>& points_m, const Pose2& T_map_base) {
  const auto [sin, cos] = sin_cos(T_map_base.theta_rad);
  std::vector<Point2> points;
  points.reserve(points_m.size());
  for (const Point2& p : points_m) {
    points.emplace_back(cos * p.x() - sin * p.y() + T_map_base.x_m, sin * p.x() + cos * p.y() + T_map_base.y_m);
  }
  return points;
}

CellIndex map_cell_at(const Point2& point_map_m, double resolution_m) {
  return {cell_floor(point_map_m.x() / resolution_m), cell_floor(point_map_m.y() / resolution_m)};
}

CellBox points_window(const std::vector<Point2>& points_map_m, double resolution_m, std::int32_t margin) {
  if (points_map_m.empty()) return {};
  Point2 low = points_map_m.front();
  Point2 high = low;
  for (const Point2& p : points_map_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const CellOffset grow{margin, margin};
  return {map_cell_at(low, resolution_m) - grow, map_cell_at(high, resolution_m) + grow + CellOffset{1, 1}};
}

KeyframeCells make_keyframe_cells(const std::vector<Point2>& points_map_m, double resolution_m,
                                  std::uint32_t radius_cells) {
  KeyframeCells keyframe{points_window(points_map_m, resolution_m, static_cast<std::int32_t>(radius_cells)), {}};
  const CellBox& window = keyframe.window;
  if (window.width() > kMostWindowCells || window.height() > kMostWindowCells) {
    throw InputError("a scan spans " + std::to_string(window.width()) + " x " + std::to_string(window.height()) +
                     " cells, more than " + std::to_string(kMostWindowCells) +
                     " along a side; lower scan.max_range or raise map.resolution");
  }
  keyframe.cells.reserve(points_map_m.size());
  for (const Point2& point : points_map_m) {
    const CellOffset d = map_cell_at(point, resolution_m) - window.min;
    const std::uint32_t cell = static_cast<std::uint32_t>(d.dy) << 16U | static_cast<std::uint32_t>(d.dx);
    if (keyframe.cells.empty() || keyframe.cells.back() != cell) keyframe.cells.push_back(cell);
  }
  return keyframe;
}

}  // namespace gdtslam
