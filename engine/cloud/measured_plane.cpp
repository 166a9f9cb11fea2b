#include "measured_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kMostNodes = 4e6;
constexpr double kStepsOfGap = 8.0;

PlanePoint turned(const PlanePoint& point, const SinCos<double>& turn) {
  return {turn.cos * point[0] + turn.sin * point[1], turn.cos * point[1] - turn.sin * point[0]};
}

double box_area_m2(std::span<const PlanePoint> points, double turn_rad) {
  const SinCos<double> turn = sin_cos(turn_rad);
  PlaneBox box{turned(points.front(), turn), turned(points.front(), turn)};
  for (const PlanePoint& point : points) {
    const PlanePoint at = turned(point, turn);
    for (const std::size_t axis : {0U, 1U}) {
      box.low[axis] = std::min(box.low[axis], at[axis]);
      box.high[axis] = std::max(box.high[axis], at[axis]);
    }
  }
  return box.length_m(0) * box.length_m(1);
}

// Nodes of a grid, each seen or not, by rows.
struct Nodes {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> is_seen;
  [[nodiscard]] std::size_t index(std::size_t column, std::size_t row) const { return row * width + column; }
};

// Along one line of `count` nodes, `stride` apart: a node becomes `value` if one within `reach` of it is.
void spread_line(std::uint8_t* line, std::size_t count, std::size_t stride, std::size_t reach, std::uint8_t value,
                 std::vector<std::uint8_t>& was) {
  was.resize(count);
  for (std::size_t k = 0; k < count; ++k) was[k] = line[k * stride];
  std::size_t until = 0;  // end of the last run that was set
  for (std::size_t k = 0; k < count; ++k) {
    if (was[k] != value) continue;
    const std::size_t end = std::min(count, k + reach + 1);
    for (std::size_t n = std::max(until, k - std::min(k, reach)); n < end; ++n) line[n * stride] = value;
    until = end;
  }
}

void spread(Nodes& nodes, std::size_t reach, std::uint8_t value) {
  std::vector<std::uint8_t> was;
  for (std::size_t row = 0; row < nodes.height; ++row) {
    spread_line(nodes.is_seen.data() + nodes.index(0, row), nodes.width, 1, reach, value, was);
  }
  for (std::size_t column = 0; column < nodes.width; ++column) {
    spread_line(nodes.is_seen.data() + column, nodes.height, nodes.width, reach, value, was);
  }
}

// Squares with four seen corners: a row of n + 1 nodes is n squares long, like the points at its ends.
std::size_t whole_squares(const Nodes& nodes) {
  std::size_t count = 0;
  for (std::size_t row = 0; row + 1 < nodes.height; ++row) {
    for (std::size_t column = 0; column + 1 < nodes.width; ++column) {
      const std::uint8_t* const corner = nodes.is_seen.data() + nodes.index(column, row);
      count += static_cast<std::size_t>(corner[0] & corner[1] & corner[nodes.width] & corner[nodes.width + 1]);
    }
  }
  return count;
}

constexpr double kCosineOfLevel = 0.984807753012208;  // cosine of 10 deg
constexpr double kSineOfUpright = 0.17364817766693;   // sine of 10 deg
constexpr double kSameLevel_m = 0.1;
constexpr std::size_t kSample = 1U << 18U;

bool is_level(const Plane& plane) { return std::fabs(plane.normal.z()) >= kCosineOfLevel; }
bool is_upright(const Plane& plane) { return std::fabs(plane.normal.z()) <= kSineOfUpright; }

// Takes evenly spaced points, enough for floor and ceiling.
Cloud take_sample(std::span<const CloudPoint> cloud) {
  const std::size_t stride = cloud.size() / kSample + 1;
  Cloud sample;
  for (std::size_t k = 0; k < cloud.size(); k += stride) {
    if (is_finite(cloud[k])) sample.push_back(cloud[k]);
  }
  return sample;
}

bool is_at(const std::optional<PlanePatch>& surface, const PlanePatch& patch) {
  return surface && std::fabs(surface->plane.distance_m(patch.centre)) <= kSameLevel_m;
}

PlaneKind plane_kind(const PlanePatch& patch, const LevelSurfaces& surfaces) {
  if (is_upright(patch.plane)) return PlaneKind::kWall;
  if (!is_level(patch.plane)) return PlaneKind::kSlope;
  if (is_at(surfaces.floor, patch)) return PlaneKind::kFloor;
  return is_at(surfaces.ceiling, patch) ? PlaneKind::kCeiling : PlaneKind::kLevel;
}

void orient(Plane& plane) {
  const bool points_back = is_upright(plane) ? plane.offset_m < 0.0 : plane.normal.z() < 0.0;
  if (!points_back) return;
  plane.normal = -plane.normal;
  plane.offset_m = -plane.offset_m;
}

MeasuredPlane measured(std::span<const CloudPoint> cloud, PlanePatch patch, const LevelSurfaces& surfaces,
                       double gap_m) {
  orient(patch.plane);
  MeasuredPlane plane{.patch = std::move(patch), .kind = {}, .area_m2 = 0.0, .extent_m = {}};
  plane.kind = plane_kind(plane.patch, surfaces);
  const PlaneAxes axes = plane_axes(plane.patch.plane.normal, is_level(plane.patch.plane));
  std::vector<PlanePoint> points;
  points.reserve(plane.patch.points.size());
  for (const std::uint32_t k : plane.patch.points) {
    const Point3 from_centre = to_position(cloud[k]) - plane.patch.centre;
    points.push_back({from_centre.dot(axes.along), from_centre.dot(axes.up)});
  }
  if (is_level(plane.patch.plane)) points = turned_into_smallest_box(points);
  const PlaneBox box = box_around(points);
  plane.extent_m = {box.length_m(0), box.length_m(1)};
  plane.area_m2 = area_of_points_m2(points, gap_m);
  return plane;
}

}  // namespace

PlaneAxes plane_axes(const Point3& normal, bool is_level) {
  const Point3 along = (is_level ? Point3::UnitY() : Point3::UnitZ()).cross(normal).normalized();
  return {along, normal.cross(along).normalized()};
}

PlaneBox box_around(std::span<const PlanePoint> points) {
  PlaneBox box{points.front(), points.front()};
  for (const PlanePoint& point : points) {
    for (const std::size_t axis : {0U, 1U}) {
      box.low[axis] = std::min(box.low[axis], point[axis]);
      box.high[axis] = std::max(box.high[axis], point[axis]);
    }
  }
  return box;
}

// Tries every degree of a quarter turn, then finer steps about the best.
std::vector<PlanePoint> turned_into_smallest_box(std::span<const PlanePoint> points) {
  double best_rad = 0.0;
  double best_m2 = box_area_m2(points, 0.0);
  const auto try_about = [&](double middle_rad, double step_rad, int steps) {
    for (int k = -steps; k <= steps; ++k) {
      const double turn_rad = middle_rad + k * step_rad;
      const double area_m2 = box_area_m2(points, turn_rad);
      if (area_m2 >= best_m2) continue;
      best_m2 = area_m2;
      best_rad = turn_rad;
    }
  };
  try_about(0.0, rad_from_deg(1.0), 45);
  for (const double step_deg : {0.1, 0.01}) try_about(best_rad, rad_from_deg(step_deg), 10);
  std::vector<PlanePoint> all;
  all.reserve(points.size());
  const SinCos<double> turn = sin_cos(best_rad);
  for (const PlanePoint& point : points) all.push_back(turned(point, turn));
  const PlaneBox box = box_around(all);
  if (box.length_m(1) > box.length_m(0)) {
    for (PlanePoint& point : all) point = {point[1], -point[0]};
  }
  return all;
}

double area_of_points_m2(std::span<const PlanePoint> points, double gap_m) {
  const PlaneBox box = box_around(points);
  const double step_m = std::max(gap_m / kStepsOfGap, std::sqrt(box.length_m(0) * box.length_m(1) / kMostNodes));
  const auto reach = static_cast<std::size_t>(std::lround(0.5 * gap_m / step_m));
  const std::size_t border = reach + 1;  // border that stays empty after the points have spread
  const auto node = [&](const PlanePoint& point, std::size_t axis) {
    return border + static_cast<std::size_t>(std::lround((point[axis] - box.low[axis]) / step_m));
  };
  Nodes nodes{.width = node(box.high, 0) + border + 1, .height = node(box.high, 1) + border + 1, .is_seen = {}};
  nodes.is_seen.assign(nodes.width * nodes.height, 0);
  for (const PlanePoint& point : points) nodes.is_seen[nodes.index(node(point, 0), node(point, 1))] = 1;
  spread(nodes, reach, 1);
  spread(nodes, reach, 0);
  return static_cast<double>(whole_squares(nodes)) * step_m * step_m;
}

std::string_view to_string(PlaneKind kind) {
  constexpr std::array<std::string_view, 5> kNames{"wall", "floor", "ceiling", "level", "slope"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<MeasuredPlane> measured_planes(std::span<const CloudPoint> cloud, std::vector<PlanePatch> patches,
                                           double gap_m) {
  if (patches.empty()) return {};
  const LevelSurfaces surfaces = find_level_surfaces(take_sample(cloud), {});
  std::vector<MeasuredPlane> planes;
  planes.reserve(patches.size());
  for (PlanePatch& patch : patches) planes.push_back(measured(cloud, std::move(patch), surfaces, gap_m));
  std::stable_sort(planes.begin(), planes.end(),
                   [](const MeasuredPlane& a, const MeasuredPlane& b) { return a.area_m2 > b.area_m2; });
  return planes;
}

}  // namespace gdtslam
