#include "map_of_keyframes.hpp"

#include <vector>

#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// What a run that closes loops keeps of its scans until the end.
void round_to_floats(std::vector<Point2>& points) {
  for (Point2& point : points) point = point.cast<float>().cast<double>();
}

}  // namespace

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config) {
  auto map = std::make_unique<SeparateMap>(config);
  ScanPoints scan_points(config.scan);
  for (const RunKeyframe& keyframe : run.keyframes) {
    std::vector<Point2> points = scan_points.of(keyframe.laser);
    if (run.in_single_precision) round_to_floats(points);
    map->merge(points, keyframe.T_map_base);
  }
  return map;
}

}  // namespace gdtslam
