#include "gdtslam/mapping/mapper.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "device_map.hpp"
#include "engine/mapping/map/stage_timer.hpp"
#include "engine/mapping/match/matcher.hpp"
#include "engine/mapping/match/motion_model.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
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

double distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Pose2& a, const Pose2& b) { return std::fabs(wrap_angle(a.theta_rad - b.theta_rad)); }

}  // namespace

struct Mapper::State {
  State(const MapperConfig& c, Backend& backend, MapperOptions options)
      : config(checked(c)), map(config, backend, std::move(options)), motion(config.odometry) {}

  void start(PointScan scan, const std::optional<Pose2>& T_odom_base);
  void see(PointScan scan);
  void predict(const std::optional<Pose2>& T_odom_base);
  void begin_match();
  MatchResult locate();
  [[nodiscard]] bool is_keyframe(const Pose2& pose) const;
  [[nodiscard]] bool wants_search(const Pose2& predicted) const;
  void update_map(MatchResult& result);
  void merge(const Pose2& pose);
  void note_keyframe(const Pose2& pose);
  void count(const MatchResult& result);

  MapperConfig config;
  DeviceMap map;
  MotionModel motion;
  MapperStatistics statistics;
  bool started = false;
  Pose2 last_keyframe;
  Pose2 last_pose;
  double unmatched_m = 0.0;  // path since the last accepted match

  // The scan in hand, from start() to finish().
  bool in_hand = false;
  bool is_matched = false;  // the matcher is at work on it
  double stamp_s = 0.0;
  Prediction prediction;
  std::vector<Point2> points_m;
  std::vector<PointCells> points;
};

// The returns of the scan in the robot's frame, the P of equation (6). A scan with more than a matcher takes is thinned
// for matching, not for the map.
void Mapper::State::see(PointScan scan) {
  stamp_s = scan.stamp_s;
  points_m = std::move(scan.points_base_m);
  points = in_cells(points_m, config.map.resolution_m);
  if (points.size() <= Matcher::kMostPoints) return;
  const std::size_t every = (points.size() + Matcher::kMostPoints - 1) / Matcher::kMostPoints;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
}

void Mapper::State::predict(const std::optional<Pose2>& T_odom_base) {
  const StageTimer timer(statistics.stages.predict_s);
  prediction = motion.predict(T_odom_base);
}

// Equations (6) to (8) and (4) for a scan that can be matched; the first one is the map's origin.
void Mapper::State::begin_match() {
  is_matched = started && points.size() >= static_cast<std::size_t>(config.scan.min_points);
  if (!is_matched) return;
  const StageTimer timer(statistics.stages.match_s);
  map.start_match(points, prediction, wants_search(prediction.T_map_base));
}

MatchResult Mapper::State::locate() {
  if (is_matched) {
    const StageTimer timer(statistics.stages.match_s);
    return map.finish_match();
  }
  MatchResult result;
  result.T_map_base = result.T_map_predicted = prediction.T_map_base;
  result.points = static_cast<std::uint32_t>(points.size());
  result.accepted = points.size() >= static_cast<std::size_t>(config.scan.min_points);
  if (!result.accepted) result.doubt = Doubt::kFewPoints;
  return result;
}

bool Mapper::State::is_keyframe(const Pose2& pose) const {
  return !started || config.keyframe.every_scan || distance(pose, last_keyframe) >= config.keyframe.distance_m ||
         turn(pose, last_keyframe) >= config.keyframe.angle_rad;
}

bool Mapper::State::wants_search(const Pose2& predicted) const {
  return config.search.when == SearchWhen::kAlways ||
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
  const KeyframeCells keyframe =
      keyframe_of(in_map(points_m, pose), config.map.resolution_m, config.map.radius_cells());
  try {
    map.merge(keyframe, statistics.stages);
  } catch (const DeviceError&) {
    note_keyframe(pose);
    throw;
  }
  note_keyframe(pose);
}

void Mapper::State::note_keyframe(const Pose2& pose) {
  last_keyframe = pose;
  started = true;
  ++statistics.keyframes;
}

void Mapper::State::count(const MatchResult& result) {
  ++statistics.scans;
  statistics.matched += result.accepted ? 1 : 0;
  statistics.doubtful += result.doubt != Doubt::kNone ? 1 : 0;
  statistics.searches += result.attempts > 0 ? 1 : 0;
  statistics.attempts += result.attempts;
  statistics.evaluations += result.evaluations;
  statistics.without_odometry += prediction.by_odometry ? 0 : 1;
  statistics.odometry_leaps = motion.leaps();
  statistics.path_m += distance(result.T_map_base, last_pose);
}

Mapper::Mapper(const MapperConfig& config, Backend& backend, MapperOptions options)
    : state_(std::make_unique<State>(config, backend, std::move(options))) {}
Mapper::~Mapper() = default;
const MapperConfig& Mapper::config() const { return state_->config; }
const GlobalField& Mapper::field() const { return state_->map.field(); }
const std::string& Mapper::device_loss() const { return state_->map.loss(); }
std::vector<std::uint16_t> Mapper::download_device_cells() { return state_->map.download_device_cells(); }

const MapperStatistics& Mapper::statistics() const {
  state_->map.count_work(state_->statistics);
  return state_->statistics;
}

void Mapper::start(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  state_->start({scan.stamp_s, points_of(scan, valid_ranges(state_->config))}, T_odom_base);
}

void Mapper::start(PointScan scan, const std::optional<Pose2>& T_odom_base) {
  state_->start(std::move(scan), T_odom_base);
}

void Mapper::State::start(PointScan scan, const std::optional<Pose2>& T_odom_base) {
  assert(!in_hand);
  map.require_device();
  see(std::move(scan));
  predict(T_odom_base);  // (5)
  try {
    begin_match();  // (6), (7), (8), (4)
  } catch (const DeviceError&) {
    motion.correct(prediction.T_map_base, false);  // the scan is lost, its motion is not
    throw;
  }
  in_hand = true;
}

MatchResult Mapper::finish() {
  State& s = *state_;
  assert(s.in_hand);
  s.in_hand = false;
  MatchResult result;
  try {
    result = s.locate();
  } catch (const DeviceError&) {
    s.motion.correct(s.prediction.T_map_base, false);
    throw;
  }
  s.motion.correct(result.T_map_base, result.accepted);
  s.update_map(result);  // (1), (9), (10), (11)
  s.count(result);
  s.last_pose = result.T_map_base;
  result.stamp_s = s.stamp_s;
  return result;
}

}  // namespace gdtslam
