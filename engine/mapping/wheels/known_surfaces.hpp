// Which surfaces the local map knows: the cells in which keyframes had returns. A scan that sees a wall for the first
// time has nothing there to be matched with, so that wall tells nothing of its pose yet. Frame: map. Not thread-safe.
// Cost: a look-up in a hash table a point.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_set>

#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class KnownSurfaces {
 public:
  /// A keyframe that went into the map.
  void add(std::span<const Point2> points_base_m, const Pose2& T_map_base);
  /// The local map gives way to the one that was begun a stretch ago.
  void begin_stretch();
  /// The part of a scan that lies on known surfaces.
  [[nodiscard]] KeptScan known_part(const KeptScan& scan, const Pose2& T_map_base) const;

 private:
  [[nodiscard]] bool is_known(const Point2& point_map_m) const;

  std::unordered_set<std::uint64_t> cells_;
  std::unordered_set<std::uint64_t> next_;  // since the last stretch began
};

}  // namespace gdtslam
