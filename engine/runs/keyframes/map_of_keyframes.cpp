#include "map_of_keyframes.hpp"

#include <numeric>
#include <vector>

#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// What a run that closes loops keeps of its scans until the end.
void round_to_floats(std::vector<Point2>& points) {
  for (Point2& point : points) point = point.cast<float>().cast<double>();
}

}  // namespace

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config) {
  auto map = std::make_unique<SeparateMap>(config);
  ScanPoints scan_points(config.scan);
  for (const std::size_t k : which) {
    const RunKeyframe& keyframe = run.keyframes[k];
    std::vector<Point2> points = scan_points.of(keyframe.laser);
    if (run.in_single_precision) round_to_floats(points);
    map->merge(points, keyframe.T_map_base);
  }
  return map;
}

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config) {
  std::vector<std::size_t> all(run.keyframes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return map_of_keyframes(run, all, config);
}

}  // namespace gdtslam
