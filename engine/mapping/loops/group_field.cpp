#include "group_field.hpp"

#include <algorithm>
#include <string>

#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

MapperConfig field_config(double resolution_m) {
  MapperConfig config;
  config.map.resolution_m = resolution_m;
  config.merge.threshold_m = resolution_m;
  return config;
}

}  // namespace

FieldCopy make_distance_field(const std::vector<Point2>& points_m, double resolution_m, Backend& backend,
                              std::mutex& backend_mutex) {
  const MapperConfig config = field_config(resolution_m);
  const std::uint32_t radius = config.map.radius_cells();
  if (radius < 1 || radius > 255) {
    throw ConfigError("distances reach over " + std::to_string(radius) +
                      " cells of the loops' resolution, not 1 to 255");
  }
  const KeyframeCells cells = make_keyframe_cells(points_m, resolution_m, radius);
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
