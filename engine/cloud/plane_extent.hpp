// Extent and area of the points of a plane in its own two axes. Metres; O(points).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// A place in a plane, along two axes at right angles.
using PlanePoint = std::array<double, 2>;

/// Two axes of length 1 in a plane, at right angles to its normal: along the level, and up the plane. Those of a level
/// plane are x and y as nearly as it allows.
struct PlaneAxes {
  Point3 along = Point3::UnitX();
  Point3 up = Point3::UnitY();
};
PlaneAxes plane_axes(const Point3& normal, bool is_level);

/// The box around points, in their axes.
struct PlaneBox {
  PlanePoint low{};
  PlanePoint high{};
  [[nodiscard]] double length_m(std::size_t axis) const { return high[axis] - low[axis]; }
};
PlaneBox box_around(std::span<const PlanePoint> points);

/// The points turned so that their box is the smallest of all, its longer side first, to a hundredth of a degree.
std::vector<PlanePoint> turned_into_smallest_box(std::span<const PlanePoint> points);

/// The area of points that lie at most `gap_m` from each other: that of their morphological closing by a square of this
/// side, on a grid of an eighth of it (coarser where that has more than four million nodes).
double area_of_points_m2(std::span<const PlanePoint> points, double gap_m);

}  // namespace gdtslam
