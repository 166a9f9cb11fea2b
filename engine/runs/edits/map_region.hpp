// A region of a map by the corners of its outline, and what is taken out of scans and of the occupancy map by regions.
// Frame: the edited map. Thread-safe; linear in the corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

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

/// Regions in which readings may not end, and regions in which they have to.
struct EndRules {
  std::span<const MapRegion> erased{};
  std::span<const MapRegion> kept{};
};

/// Makes readings that end where they must not no returns, and tells how many; ranges that are no return stay.
/// O(beams x corners).
std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan);

/// The part of the map that holds all cells whose centres are in every region, the others in it unknown; the map itself
/// where there are no regions. Throws InputError where nothing is left. O(cells).
OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept);

}  // namespace gdtslam
