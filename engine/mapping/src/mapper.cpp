#include "gdtslam/mapping/mapper.hpp"

#include <chrono>
#include <cmath>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/local_field.hpp"
#include "gdtslam/mapping/motion_model.hpp"
#include "gdtslam/mapping/scan_matcher.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

const MapperConfig& checked(const MapperConfig& config) {
  const std::vector<std::string> found = validate(config);
  if (found.empty()) return config;
  std::string text = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  throw ConfigError(text);
}

class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(&seconds), start_(Clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { *seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double* seconds_;
  Clock::time_point start_;
};

// More terms of 16 bits could overflow the sum of a cost; a larger scan is thinned for matching, not for the map.
constexpr std::size_t kMostPoints = 65537;

double distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Pose2& a, const Pose2& b) { return std::fabs(wrap_angle(a.theta_rad - b.theta_rad)); }

}  // namespace

struct Mapper::State {
  State(const MapperConfig& c, Backend& backend)
      : config(checked(c)),
        field(backend, config.map.resolution_m, config.map.radius_cells(),
              static_cast<std::uint64_t>(config.map.max_megacells) << 20U),
        local(backend, config.map.radius_cells()),
        motion(config.odometry),
        matcher(config, backend, field) {}

  void see(const LaserScan& scan);
  Prediction predict(const std::optional<Pose2>& T_odom_base);
  MatchResult locate(const Prediction& prediction);
  [[nodiscard]] bool is_keyframe(const Pose2& pose) const;
  [[nodiscard]] bool wants_search(const Pose2& predicted) const;
  void update_map(MatchResult& result);
  void merge(const Pose2& pose);
  void count(const MatchResult& result, const Prediction& prediction);

  MapperConfig config;
  GlobalField field;
  LocalField local;
  MotionModel motion;
  ScanMatcher matcher;
  MapperStatistics statistics;
  bool started = false;
  Pose2 last_keyframe;
  Pose2 last_pose;
  double unmatched_m = 0.0;  // path since the last accepted match
  std::vector<Point2> points_m;
  std::vector<PointCells> points;
};

// The returns of the scan in the robot's frame, the P of equation (6).
void Mapper::State::see(const LaserScan& scan) {
  points_m = points_of(scan, {.min_m = config.scan.min_range_m, .max_m = config.scan.max_range_m});
  points = in_cells(points_m, config.map.resolution_m);
  if (points.size() <= kMostPoints) return;
  const std::size_t every = (points.size() + kMostPoints - 1) / kMostPoints;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
}

Prediction Mapper::State::predict(const std::optional<Pose2>& T_odom_base) {
  const StageTimer timer(statistics.stages.predict_s);
  return motion.predict(T_odom_base);
}

// Equations (6) to (8) and (4); the first scan is the map's origin.
MatchResult Mapper::State::locate(const Prediction& prediction) {
  MatchResult result;
  result.T_map_base = result.T_map_predicted = prediction.T_map_base;
  result.points = static_cast<std::uint32_t>(points.size());
  if (points.size() < static_cast<std::size_t>(config.scan.min_points)) {
    result.doubt = Doubt::kFewPoints;
    return result;
  }
  if (!started) {
    result.accepted = true;
    return result;
  }
  const StageTimer timer(statistics.stages.match_s);
  return matcher.match(points, prediction, wants_search(prediction.T_map_base));
}

bool Mapper::State::is_keyframe(const Pose2& pose) const {
  return !started || config.keyframe.every_scan || distance(pose, last_keyframe) >= config.keyframe.distance_m ||
         turn(pose, last_keyframe) >= config.keyframe.angle_rad;
}

bool Mapper::State::wants_search(const Pose2& predicted) const {
  return config.match.matcher == MatcherKind::kExhaustive || config.search.when == SearchWhen::kAlways ||
         (config.search.when == SearchWhen::kKeyframe && is_keyframe(predicted));
}

// Equations (9) to (11) with the local field of (1), for keyframes; and where nothing matched for so long that the
// robot must be somewhere new, a fresh start there, because the map could never grow to it otherwise.
void Mapper::State::update_map(MatchResult& result) {
  unmatched_m = result.accepted ? 0.0 : unmatched_m + distance(result.T_map_base, last_pose);
  const bool restart = !result.accepted && result.doubt != Doubt::kFewPoints && unmatched_m >= config.doubt.restart_m;
  if (restart || (result.accepted && is_keyframe(result.T_map_base))) {
    merge(result.T_map_base);
    result.merged = true;
  }
  if (restart) {
    ++statistics.restarts;
    unmatched_m = 0.0;
  }
}

void Mapper::State::merge(const Pose2& pose) {
  const auto radius = static_cast<std::int32_t>(config.map.radius_cells());
  const std::vector<Point2> points_map_m = in_map(points_m, pose);
  const CellBox window = window_of(points_map_m, config.map.resolution_m, radius);
  field.grow_to_hold(window);
  {
    const StageTimer timer(statistics.stages.local_field_s);
    local.compute(points_map_m, config.map.resolution_m, window);
  }
  const StageTimer timer(statistics.stages.merge_s);
  const double threshold = config.merge.threshold_m / config.map.resolution_m * kFieldOne;
  local.merge_into(field, config.merge.rule, static_cast<std::uint32_t>(std::lround(threshold)),
                   static_cast<std::uint32_t>(std::lround(threshold * config.merge.kappa)));
  last_keyframe = pose;
  started = true;
  ++statistics.keyframes;
}

void Mapper::State::count(const MatchResult& result, const Prediction& prediction) {
  ++statistics.scans;
  statistics.matched += result.accepted ? 1 : 0;
  statistics.doubtful += result.doubt != Doubt::kNone ? 1 : 0;
  statistics.searches += result.searched ? 1 : 0;
  statistics.evaluations += result.evaluations;
  statistics.without_odometry += prediction.by_odometry ? 0 : 1;
  statistics.odometry_leaps = motion.leaps();
  statistics.path_m += distance(result.T_map_base, last_pose);
}

Mapper::Mapper(const MapperConfig& config, Backend& backend) : state_(std::make_unique<State>(config, backend)) {}
Mapper::~Mapper() = default;
const MapperConfig& Mapper::config() const { return state_->config; }
const MapperStatistics& Mapper::statistics() const { return state_->statistics; }
const GlobalField& Mapper::field() const { return state_->field; }

MatchResult Mapper::process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  s.see(scan);
  const Prediction prediction = s.predict(T_odom_base);  // (5)
  MatchResult result = s.locate(prediction);             // (6), (7), (8), (4)
  s.motion.correct(result.T_map_base, result.accepted);
  s.update_map(result);  // (1), (9), (10), (11)
  s.count(result, prediction);
  s.last_pose = result.T_map_base;
  result.stamp_s = scan.stamp_s;
  return result;
}

}  // namespace gdtslam
