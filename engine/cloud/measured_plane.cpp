#include "measured_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "gdtslam/cloud/thinning.hpp"
#include "plane_extent.hpp"
#include "to_position.hpp"

namespace gdtslam {
namespace {

constexpr double kCosineOfLevel = 0.984807753012208;  // cosine of 10 deg
constexpr double kSineOfUpright = 0.17364817766693;   // sine of 10 deg
constexpr double kSameLevel_m = 0.1;
constexpr std::size_t kSample = 1U << 18U;

bool is_level(const Plane& plane) { return std::fabs(plane.normal.z()) >= kCosineOfLevel; }
bool is_upright(const Plane& plane) { return std::fabs(plane.normal.z()) <= kSineOfUpright; }

// Points evenly taken, enough for floor and ceiling.
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
