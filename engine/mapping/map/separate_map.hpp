// A map on a CPU backend of its own, which lives as long as it does: it may be handed on, also to another thread. One
// thread at a time while it is made; then it stays as it is. Cost: some 0.5 ms a keyframe.
#pragma once

#include <memory>
#include <vector>

#include "keyframe_map.hpp"

namespace gdtslam {

class SeparateMap {
 public:
  explicit SeparateMap(const MapperConfig& config);
  /// Paper equations (1) and (9) to (11); nothing where there are no points. Throws InputError where the map would be
  /// beyond map.max_megacells.
  void merge(const std::vector<Point2>& points_base_m, const Pose2& T_map_base);
  [[nodiscard]] const GlobalField& field() const { return map_.field; }

 private:
  MapConfig config_;
  std::unique_ptr<Backend> cpu_;
  KeyframeMap map_;
};

}  // namespace gdtslam
