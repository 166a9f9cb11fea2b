#include "cloud_level.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloud_colours.hpp"
#include "engine/cloud/to_position.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kLevelSample = 250000;
constexpr double kStrayLevelShare = 0.001;

}  // namespace

LevelSurfaces level_surfaces_of(std::span<const CloudPoint> cloud) {
  Cloud sample;
  const std::size_t step = std::max<std::size_t>(1, (cloud.size() + kLevelSample - 1) / kLevelSample);
  sample.reserve(cloud.size() / step + 1);
  for (std::size_t k = 0; k < cloud.size(); k += step) {
    if (is_finite(cloud[k])) sample.push_back(cloud[k]);
  }
  return find_level_surfaces(sample, {});
}

double height_m(const Plane& plane, const Point2& at) {
  return (plane.offset_m - plane.normal.x() * at.x() - plane.normal.y() * at.y()) / plane.normal.z();
}

std::vector<std::uint32_t> drawn_points(std::span<const CloudPoint> cloud, const LevelSurfaces& surfaces,
                                        const CloudLook& look) {
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError("the cloud has " + std::to_string(cloud.size()) + " points; a picture takes at most 4294967295");
  }
  std::vector<std::uint32_t> drawn;
  drawn.reserve(cloud.size());
  bool has_any = false;
  for (std::uint32_t k = 0; k < cloud.size(); ++k) {
    if (!is_finite(cloud[k])) continue;
    has_any = true;
    const Point3 place = to_position(cloud[k]);
    if (!look.with_floor && surfaces.floor && surfaces.floor->plane.distance_m(place) <= kFloorMargin_m) continue;
    if (!look.with_ceiling && surfaces.ceiling && surfaces.ceiling->plane.distance_m(place) >= -kCeilingMargin_m) {
      continue;
    }
    drawn.push_back(k);
  }
  if (!has_any) throw InputError("the cloud has no points to show");
  if (drawn.empty()) throw InputError("the cloud is nothing but floor and ceiling; draw it with them");
  return drawn;
}

Bounds robust_bounds(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) {
  Bounds bounds;
  std::vector<float> along(drawn.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const CloudPoint& point = cloud[drawn[k]];
      along[k] = axis == 0 ? point.x_m : axis == 1 ? point.y_m : point.z_m;
    }
    bounds.lowest[axis] = static_cast<double>(percentile(along, kStrayLevelShare));
    bounds.highest[axis] = static_cast<double>(percentile(along, 1.0 - kStrayLevelShare));
  }
  return bounds;
}

}  // namespace gdtslam
