// Surfaces that the local map knows: the cells in which keyframes had returns. A wall that a scan sees for the first
// time has no counterpart in the map, so it gives no information about the pose yet. Frame: map. Not thread-safe. Cost:
// a look-up in a hash table a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class KnownSurfaces {
 public:
  /// Adds a keyframe that went into the map.
  void add(std::span<const Point2> points_base_m, const Pose2& T_map_base);
  /// Replaces the local map by the one that was begun a stretch ago.
  void begin_stretch();
  /// The part of a scan that lies on known surfaces.
  [[nodiscard]] KeptScan known_part(const KeptScan& scan, const Pose2& T_map_base) const;
  /// The points without lone returns far along a wall beyond its known part. Such a return lies between those of
  /// earlier scans, the nearest of which is always behind: it would pull a match back, by several per cent of the way
  /// if little stands across. It counts if the map knows the wall on both sides of it.
  [[nodiscard]] std::vector<Point2> without_wall_ends(std::span<const Point2> points_base_m,
                                                      const Pose2& T_map_base) const;
  /// The keyframe of the local map, in the order added, that first saw the surface at a known point.
  [[nodiscard]] std::size_t first_seen(const Point2& point_map_m) const;

 private:
  // The first keyframe with a return in the cell or beside it.
  struct Known {
    std::size_t first = 0;
    bool has_return = false;  // in the cell itself
  };
  using Cells = std::unordered_map<std::uint64_t, Known>;
  void add_cell(std::int64_t x, std::int64_t y, Cells& cells) const;
  // True if a wall through this point along `direction` (of length 1) is known half a metre to both sides.
  [[nodiscard]] bool goes_on(const Point2& point_map_m, const Point2& direction) const;
  [[nodiscard]] std::optional<std::size_t> first_near(const Point2& point_map_m) const;

  Cells cells_;
  Cells next_;  // cells since the last stretch began
  std::size_t keyframes_ = 0;
};

}  // namespace gdtslam
