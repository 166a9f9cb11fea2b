#include "separate_map.hpp"

#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

SeparateMap::SeparateMap(const MapperConfig& config)
    : config_(config.map), cpu_(make_cpu_backend({})), map_(config, *cpu_) {}

void SeparateMap::merge(const std::vector<Point2>& points_base_m, const Pose2& T_map_base) {
  if (points_base_m.empty()) return;
  StageTimes times;
  map_.merge(make_keyframe_cells(in_map(points_base_m, T_map_base), config_.resolution_m, config_.radius_cells()),
             times);
}

}  // namespace gdtslam
