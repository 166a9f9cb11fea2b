#include "keyframe_map.hpp"

#include <cmath>
#include <limits>

#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

MergeStep merge_step(const MapperConfig& config) {
  const double threshold = config.merge.threshold_m / config.map.resolution_m * kFieldOne;
  return {.rule = config.merge.rule,
          .threshold = static_cast<std::uint32_t>(std::lround(threshold)),
          .lift = static_cast<std::uint32_t>(std::lround(threshold * config.merge.kappa))};
}

std::uint64_t most_cells(const MapConfig& config, const Backend& backend) {
  if (backend.device().kind != "cpu") return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(config.max_megacells) << 20U;
}

}  // namespace

KeyframeMap::KeyframeMap(const MapperConfig& config, Backend& backend)
    : field(backend, config.map.resolution_m, config.map.radius_cells(), most_cells(config.map, backend)),
      local(backend, config.map.radius_cells(), config.map.transform),
      step(merge_step(config)) {}

void KeyframeMap::merge(const KeyframeCells& keyframe, StageTimes& stages) {
  {
    const StageTimer timer(stages.local_field_s);
    field.grow_to_hold(keyframe.window);
    local.prepare(keyframe, field);
  }
  const StageTimer timer(stages.merge_s);
  local.merge_into(field, step);
}

SeparateMap::SeparateMap(const MapperConfig& config)
    : config_(config.map), cpu_(make_cpu_backend({})), map_(config, *cpu_) {}

void SeparateMap::merge(const std::vector<Point2>& points_base_m, const Pose2& T_map_base) {
  if (points_base_m.empty()) return;
  StageTimes times;
  map_.merge(make_keyframe_cells(in_map(points_base_m, T_map_base), config_.resolution_m, config_.radius_cells()),
             times);
}

}  // namespace gdtslam
