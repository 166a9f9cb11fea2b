// Planes of a cloud with the names that a reader uses: walls, floors, ceilings, with their area and extent. Metres,
// frame of the cloud, z up. Thread-safe; O(points) a plane and O(cloud log cloud) once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gdtslam/cloud/plane.hpp"

namespace gdtslam {

/// By the normal: walls stand within 10 deg of upright, floors, ceilings and other level planes (a table, a step) lie
/// within 10 deg of level, and all else slopes.
enum class PlaneKind : std::uint8_t { kWall, kFloor, kCeiling, kLevel, kSlope };
/// "wall", "floor", ...
std::string_view to_string(PlaneKind kind);

struct MeasuredPlane {
  /// Its normal points up, or away from the origin where it is a wall's.
  PlanePatch patch;
  PlaneKind kind = PlaneKind::kWall;
  /// Area of the surface that was seen: holes and inlets narrower than the gap count as surface.
  double area_m2 = 0.0;
  /// Extent of a wall or slope: along the level, and up it; of a level plane: the sides of the smallest rectangle
  /// around it, the longer one first.
  std::array<double, 2> extent_m{};
};

/// The same planes with what they are, the largest area first. `gap_m`: points of one surface have a neighbour this
/// close (PlaneSearch). A level plane is a floor or ceiling where it lies at the height of the lowest or highest wide
/// one of the cloud (find_level_surfaces).
std::vector<MeasuredPlane> measured_planes(std::span<const CloudPoint> cloud, std::vector<PlanePatch> patches,
                                           double gap_m);

}  // namespace gdtslam
