// A region of a map, by the corners of its outline. Thread-safe; linear in the corners.
#pragma once

#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A polygon without its last side said, in either sense of rotation; where it crosses itself, what is surrounded an
/// odd number of times is inside.
struct MapRegion {
  std::vector<Point2> corners_m;
  /// A point on the outline is inside on one of two regions that share that side.
  [[nodiscard]] bool contains(const Point2& point_m) const;
  friend bool operator==(const MapRegion&, const MapRegion&) = default;
};

/// The rectangle between two corners.
MapRegion rectangle_between(const Point2& low_m, const Point2& high_m);

/// The same region in frame a.
MapRegion in_frame(const Pose2& T_a_b, const MapRegion& region_b);

/// The corners with the least and the largest coordinates; the region has corners.
struct RegionBounds {
  Point2 low_m;
  Point2 high_m;
};
RegionBounds bounds_of(const MapRegion& region);

/// A region that many points are asked about: those beyond its bounds cost no look at its sides.
class BoundedRegion {
 public:
  /// The region has corners and outlives the object.
  explicit BoundedRegion(const MapRegion& region);
  /// As the region has it, bit for bit.
  [[nodiscard]] bool contains(const Point2& point_m) const;

 private:
  const MapRegion& region_;
  RegionBounds beyond_;
};

}  // namespace gdtslam
