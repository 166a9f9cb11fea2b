#include "map_region.hpp"

#include <cmath>
#include <cstddef>

namespace gdtslam {

bool MapRegion::contains(const Point2& point_m) const {
  bool is_inside = false;
  for (std::size_t k = 0, last = corners_m.size() - 1; k < corners_m.size(); last = k++) {
    const Point2& a = corners_m[k];
    const Point2& b = corners_m[last];
    if ((a.y() > point_m.y()) == (b.y() > point_m.y())) continue;
    const double x = a.x() + (b.x() - a.x()) * ((point_m.y() - a.y()) / (b.y() - a.y()));
    if (point_m.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

MapRegion rectangle_between(const Point2& low_m, const Point2& high_m) {
  return {{low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}}};
}

MapRegion in_frame(const Pose2& T_a_b, const MapRegion& region_b) {
  MapRegion region_a;
  region_a.corners_m.reserve(region_b.corners_m.size());
  for (const Point2& corner : region_b.corners_m) region_a.corners_m.push_back(T_a_b * corner);
  return region_a;
}

RegionBounds bounds_of(const MapRegion& region) {
  RegionBounds bounds{region.corners_m.front(), region.corners_m.front()};
  for (const Point2& corner : region.corners_m) {
    bounds.low_m = bounds.low_m.cwiseMin(corner);
    bounds.high_m = bounds.high_m.cwiseMax(corner);
  }
  return bounds;
}

// A line through the point crosses no side below the lowest corner and from the highest on, and an even number of them
// on the right of a point that lies left of all corners. How far right a side is crossed is rounded, hence the margin.
BoundedRegion::BoundedRegion(const MapRegion& region) : region_(region), beyond_(bounds_of(region)) {
  constexpr double kRoundingShare = 1.0e-9;
  const double margin_m = kRoundingShare * (std::abs(beyond_.low_m.x()) + std::abs(beyond_.high_m.x()));
  beyond_.low_m.x() -= margin_m;
  beyond_.high_m.x() += margin_m;
}

bool BoundedRegion::contains(const Point2& point_m) const {
  const bool is_beyond = point_m.y() < beyond_.low_m.y() || point_m.y() > beyond_.high_m.y() ||
                         point_m.x() < beyond_.low_m.x() || point_m.x() > beyond_.high_m.x();
  return !is_beyond && region_.contains(point_m);
}

}  // namespace gdtslam
