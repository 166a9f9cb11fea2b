#include "group_field.hpp"

#include <algorithm>

#include "engine/mapping/map/keyframe_map.hpp"

namespace gdtslam {
namespace {

MapperConfig field_config(double resolution_m) {
  MapperConfig config;
  config.map.resolution_m = resolution_m;
  config.merge.threshold_m = resolution_m;
  return config;
}

}  // namespace

FieldCopy field_of(const std::vector<Point2>& points_m, double resolution_m, Backend& backend,
                   std::mutex& backend_mutex) {
  const MapperConfig config = field_config(resolution_m);
  const KeyframeCells cells = keyframe_of(points_m, resolution_m, config.map.radius_cells());
  const std::lock_guard lock(backend_mutex);
  KeyframeMap map(config, backend);
  StageTimes times;
  map.merge(cells, times);
  return FieldCopy(map.field);
}

std::vector<Point2> every_nth(const std::vector<Point2>& points, std::size_t most) {
  const std::size_t step = (points.size() + most - 1) / std::max<std::size_t>(1, most);
  if (step <= 1) return points;
  std::vector<Point2> taken;
  for (std::size_t i = 0; i < points.size(); i += step) taken.push_back(points[i]);
  return taken;
}

}  // namespace gdtslam
