// A map on a CPU backend of its own, which lives as long as it does: it may be handed on, also to another thread. One
// thread at a time while it is made; then it stays as it is. Cost: some 0.5 ms a keyframe.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "engine/mapping/map/keyframe_map.hpp"

namespace gdtslam {

class SeparateMap {
 public:
  explicit SeparateMap(const MapperConfig& config);
  /// For maps larger than the memory meant for them: GlobalField::keep_near(). Then it stays with one thread.
  void keep_near(const std::string& folder) { map_.field.keep_near(folder); }
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
