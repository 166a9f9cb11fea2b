// How far a map reaches, and whether it is kept in one piece: what more cells than a picture of distances may be read
// back with have no use in one file, and no room in a viewer. Frame: map. Not thread-safe; O(1) a pose.
#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// 580 m x 580 m of 25 mm cells: as many as read_distance_field() takes.
inline constexpr double kMostCellsInOnePiece = static_cast<double>(std::uint64_t{1} << 29U);

class MapExtent {
 public:
  /// Beams without a return count as far as they are taken to be free.
  MapExtent(const MapperConfig& config, double no_return_free_m)
      : limit_m_(config.scan.max_range_m), reach_m_(no_return_free_m), resolution_m_(config.map.resolution_m) {}
  /// How far it sees. O(beams).
  void see(const LaserScan& scan) {
    const double limit_m = range_limit_m(scan, limit_m_);
    for (const float range : scan.ranges_m) {
      const auto range_m = static_cast<double>(range);
      if (range_m < limit_m) reach_m_ = std::max(reach_m_, range_m);
    }
  }
  void add(const Point2& robot_m) {
    low_m_ = is_empty_ ? robot_m : Point2(low_m_.cwiseMin(robot_m));
    high_m_ = is_empty_ ? robot_m : Point2(high_m_.cwiseMax(robot_m));
    is_empty_ = false;
  }
  /// Whether all that the laser may have seen from there is in one piece.
  [[nodiscard]] bool is_one_piece() const {
    if (is_empty_) return true;
    const Point2 side_m = high_m_ - low_m_ + Point2(2.0 * reach_m_, 2.0 * reach_m_);
    return side_m.x() / resolution_m_ * (side_m.y() / resolution_m_) <= kMostCellsInOnePiece;
  }

 private:
  double limit_m_;
  double reach_m_;
  double resolution_m_;
  bool is_empty_ = true;
  Point2 low_m_ = Point2::Zero();
  Point2 high_m_ = Point2::Zero();
};

}  // namespace gdtslam
