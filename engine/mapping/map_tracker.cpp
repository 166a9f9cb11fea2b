#include "map_tracker.hpp"

#include <utility>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/mapping/map/field_store.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/mapping/match/motion_model.hpp"
#include "engine/mapping/match/thinned_points.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// That of the field's grid, as far as it is one's own to choose.
MapperConfig config_for(MapperConfig config, const FieldView& map) {
  config.map.resolution_m = map.resolution_m;
  config.map.truncation_m = map.resolution_m * static_cast<double>(map.cap) / kFieldOne;
  const std::vector<std::string> found = validate(config);
  if (found.empty()) return config;
  std::string text = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  throw ConfigError(text);
}

}  // namespace

struct MapTracker::State {
  State(const MapperConfig& c, const FieldView& map, Backend& cpu)
      : config(config_for(c, map)),
        field(cpu, config.map.resolution_m, config.map.radius_cells(),
              static_cast<std::uint64_t>(config.map.max_megacells) << 20U),
        motion(config.odometry),
        scan_points(config.scan) {
    const CellBox box{map.first_cell, map.first_cell + CellOffset{static_cast<std::int32_t>(map.width),
                                                                  static_cast<std::int32_t>(map.height)}};
    field.grow_to_hold(box);
    field.require_room({&box, 1});
    field.adopt({{map.cells, std::size_t{map.stride} * map.height}, map.stride, box});
    matcher = matcher_info(config.match.matcher).make(config, field);
  }

  MapperConfig config;
  GlobalField field;
  MotionModel motion;
  ScanPoints scan_points;
  std::unique_ptr<Matcher> matcher;
};

MapTracker::MapTracker(const MapperConfig& config, const FieldView& map, Backend& cpu)
    : state_(std::make_unique<State>(config, map, cpu)) {}
MapTracker::~MapTracker() = default;

void MapTracker::start_at(const Pose2& T_map_base) {
  state_->motion = MotionModel(state_->config.odometry, T_map_base);
}

MatchResult MapTracker::process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  std::vector<PointCells> points = in_cells(s.scan_points.of(scan), s.config.map.resolution_m);
  thin(points, Matcher::kMostPoints);
  const Prediction prediction = s.motion.predict(T_odom_base);
  MatchResult result;
  if (points.size() >= static_cast<std::size_t>(s.config.scan.min_points)) {
    result = s.matcher->match(points, prediction, s.config.search.when == SearchWhen::kAlways);
  } else {
    result.T_map_base = result.T_map_predicted = prediction.T_map_base;
    result.points = static_cast<std::uint32_t>(points.size());
    result.doubt = Doubt::kFewPoints;
  }
  s.motion.correct(result.T_map_base, result.accepted);
  result.stamp_s = scan.stamp_s;
  return result;
}

}  // namespace gdtslam
