// Planes of a cloud with their everyday names: walls, floors, ceilings, with their area and extent. Metres, frame of
// the cloud, z up. Thread-safe; O(points) a plane and O(cloud log cloud) once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

// Extent and area of the points of a plane in its own two axes. Metres; O(points).

/// A position in a plane, along two axes at right angles.
using PlanePoint = std::array<double, 2>;

/// Two axes of length 1 in a plane, at right angles to its normal: along the level, and up the plane. Those of a level
/// plane are as near to x and y as possible.
struct PlaneAxes {
  Point3 along = Point3::UnitX();
  Point3 up = Point3::UnitY();
};
PlaneAxes plane_axes(const Point3& normal, bool is_level);

/// The bounding box of points, in their axes.
struct PlaneBox {
  PlanePoint low{};
  PlanePoint high{};
  [[nodiscard]] double length_m(std::size_t axis) const { return high[axis] - low[axis]; }
};
PlaneBox box_around(std::span<const PlanePoint> points);

/// Turns the points so that their box is the smallest, its longer side first, to a hundredth of a degree.
std::vector<PlanePoint> turned_into_smallest_box(std::span<const PlanePoint> points);

/// The area of points that lie at most `gap_m` from each other: that of their morphological closing by a square of this
/// side, on a grid of an eighth of it (coarser if that has more than four million nodes).
double area_of_points_m2(std::span<const PlanePoint> points, double gap_m);

/// Kinds by the normal: walls stand within 10 deg of upright; floors, ceilings and other level planes (a table, a step)
/// lie within 10 deg of level; all other planes are slopes.
enum class PlaneKind : std::uint8_t { kWall, kFloor, kCeiling, kLevel, kSlope };
/// "wall", "floor", ...
std::string_view to_string(PlaneKind kind);

struct MeasuredPlane {
  /// Its normal points up; that of a wall points away from the origin.
  PlanePatch patch;
  PlaneKind kind = PlaneKind::kWall;
  /// Area of the seen surface: holes and inlets narrower than the gap count as surface.
  double area_m2 = 0.0;
  /// Extent of a wall or slope: along the level, and up it. Extent of a level plane: the sides of the smallest
  /// rectangle around it, the longer one first.
  std::array<double, 2> extent_m{};
};

/// The same planes with their kinds, the largest area first. `gap_m`: points of one surface have a neighbour this close
/// (PlaneSearch). A level plane is a floor or ceiling if it lies at the height of the lowest or highest wide one of the
/// cloud (find_level_surfaces).
std::vector<MeasuredPlane> measured_planes(std::span<const CloudPoint> cloud, std::vector<PlanePatch> patches,
                                           double gap_m);

}  // namespace gdtslam
