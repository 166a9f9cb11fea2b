// Floor and ceiling of a cloud, and which of its points are drawn without them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// What goes with a level surface: over the floor thicker than its noise and thinner than what stands on it, under the
/// ceiling its lamps too.
inline constexpr double kFloorMargin_m = 0.06;
inline constexpr double kCeilingMargin_m = 0.25;

/// Found on at most a quarter million points spread over the cloud. O(points).
LevelSurfaces level_surfaces_of(std::span<const CloudPoint> cloud);
/// Height of a level plane at a place of the map.
double height_m(const Plane& plane, const Point2& at);
/// Indices of the points with finite coordinates that the look does not take away as floor (and below) or ceiling (and
/// above). Throws InputError where the cloud has none with finite coordinates, or more than 2^32 - 1.
std::vector<std::uint32_t> drawn_points(std::span<const CloudPoint> cloud, const LevelSurfaces& surfaces,
                                        const CloudLook& look);
/// The box of the drawn points without 0.1 % at each end of each axis.
Bounds robust_bounds(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn);

}  // namespace gdtslam
