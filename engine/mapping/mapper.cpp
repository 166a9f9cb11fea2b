#include "gdtslam/mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/compute/batch_device.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "engine/mapping/match/match_rules.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/mapping/match/motion_estimate.hpp"
#include "engine/mapping/match/pose_certainty.hpp"
#include "engine/mapping/match/scan_matcher.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

const MapperConfig& checked(const MapperConfig& config) {
  const std::vector<std::string> found = validate(config);
  if (found.empty()) return config;
  std::string text = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  throw ConfigError(text);
}

/// The map that scans are matched with, on the host, and also on a device if the matcher runs there.
struct MatchedMap {
  MatchedMap(const MapperConfig& config, Backend& cpu, Backend* on_device) : host(config, cpu) {
    if (on_device != nullptr) device.emplace(config, *on_device);
  }
  [[nodiscard]] const GlobalField& matched() const { return device ? device->field : host.field; }

  KeyframeMap host;
  std::optional<KeyframeMap> device;
};

bool is_cpu(const Backend& backend) { return backend.device().kind == "cpu"; }
double distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Pose2& a, const Pose2& b) { return std::fabs(wrap_angle(a.theta_rad - b.theta_rad)); }

}  // namespace

struct Mapper::State {
  State(const MapperConfig& c, Backend& backend, MapperOptions o);

  template <class Step>
  auto or_on_cpu(const Step& step);
  void leave_device(const DeviceError& error);
  void require_matcher() const;
  void open_matcher();
  void count_work(Backend& backend);

  void see(PointScan given);
  void predict(const std::optional<Pose2>& T_odom_base);
  MatchResult match();
  void judge(MatchResult& result);
  [[nodiscard]] bool is_keyframe(const Pose2& pose) const;
  [[nodiscard]] bool wants_search(const Pose2& predicted) const;
  void weigh(MatchResult& result);
  void update_map(MatchResult& result);
  void merge(const Pose2& pose);
  void merge_into(MatchedMap& matched, const KeyframeCells& keyframe);
  void begin_stretch();
  void count(const MatchResult& result);

  MapperConfig config;
  MapperOptions options;
  std::unique_ptr<Backend> own_cpu;  // host mapper's backend if the given one is a device
  Backend* cpu;
  Backend* device = nullptr;         // device that runs the matcher; null if none does
  std::unique_ptr<MatchedMap> map;   // map that scans are matched with
  std::unique_ptr<MatchedMap> next;  // next local map, half a stretch younger
  double stretch_m = 0.0;            // path since `next` was begun
  std::unique_ptr<ScanMatcher> matcher;
  std::optional<DeviceError> loss;
  std::string loss_text;
  Backend* at_work = nullptr;  // the backend that runs the matcher
  QueueWork work_before;       // its work before the mapper had it

  MotionModel motion;
  Patience patience;
  std::optional<MotionEstimate> estimate;  // weighs odometry and matches, if both are used
  PoseCertainty certainty;                 // covariance of the pose, if requested
  MapperStatistics statistics;
  bool started = false;
  Pose2 last_keyframe;
  Pose2 last_pose;
  double unmatched_m = 0.0;  // path since the last accepted match

  // The current scan:
  PointScan scan;
  Prediction prediction;
  ScanPoints scan_points;
  std::vector<PointCells> points;  // points for matching
  KeptScan kept;                   // its surfaces, if there is an estimate
  bool is_matched = false;         // a map exists and enough points are left after thinning

  std::unique_ptr<LoopClosing> loops;
};

// Handles all device failures during mapping: the CPU, which has the same map, repeats the step. If that is not
// allowed, or the CPU fails, the error goes to the caller. After its first error the device is not used any more.
template <class Step>
auto Mapper::State::or_on_cpu(const Step& step) {
  try {
    return step();
  } catch (const DeviceError& error) {
    leave_device(error);
  }
  return step();
}

// A matcher on the host has its map there, and a device then has nothing to do.
Mapper::State::State(const MapperConfig& c, Backend& backend, MapperOptions o)
    : config(o.with_loops ? LoopClosing::adapt_config(checked(c)) : checked(c)),
      options(std::move(o)),
      own_cpu(is_cpu(backend) ? nullptr : make_cpu_backend(options.cpu)),
      cpu(own_cpu ? own_cpu.get() : &backend),
      motion(config.odometry),
      scan_points(config.scan) {
  if (own_cpu && matcher_info(config.match.matcher).follows_slope) device = &backend;
  count_work(device != nullptr ? backend : *cpu);
  if (config.odometry.estimate) estimate.emplace();
  or_on_cpu([&] {
    map = std::make_unique<MatchedMap>(config, *cpu, device);
    if (config.local.stretch_m > 0.0) next = std::make_unique<MatchedMap>(config, *cpu, device);
    open_matcher();
  });
  if (!options.with_loops) return;
  const BatchDevice batches{.get = [this] { return device; },
                            .lost = [this](const DeviceError& error) { leave_device(error); }};
  loops = std::make_unique<LoopClosing>(config, options, batches);
}

void Mapper::State::open_matcher() { matcher = std::make_unique<ScanMatcher>(config, map->matched()); }

// A failure of the CPU is final: the same step would fail again.
void Mapper::State::leave_device(const DeviceError& error) {
  const bool was_on_cpu = device == nullptr;
  loss = error;
  loss_text = error.what();
  matcher.reset();
  device = nullptr;
  for (MatchedMap* matched : {map.get(), next.get()}) {
    if (matched != nullptr) matched->device.reset();
  }
  count_work(*cpu);
  if (!options.fall_back || was_on_cpu) throw DeviceError(error);
  if (map) open_matcher();
  if (options.warn) options.warn(loss_text + kGoingOnWithCpu);
}

// Throws the error that left the mapper without a matcher.
void Mapper::State::require_matcher() const {
  if (loss && matcher == nullptr) throw DeviceError(*loss);
}

// The mapper's counts are the sums over its backends while it used them.
void Mapper::State::count_work(Backend& backend) {
  if (at_work != nullptr) {
    statistics.dispatches += at_work->dispatch_count();
    statistics.submissions += at_work->submit_count();
    statistics.device += at_work->work() - work_before;
  }
  at_work = &backend;
  work_before = backend.work();
  statistics.dispatches -= backend.dispatch_count();
  statistics.submissions -= backend.submit_count();
}

// The returns of the scan in the robot's frame, the P of equation (6). A scan with too many points for a matcher is
// thinned for matching, not for the map.
void Mapper::State::see(PointScan given) {
  scan = std::move(given);
  points = in_cells(scan.points_base_m, config.map.resolution_m);
  points.resize(points.size() - scan.unknown_points);
  thin(points, kMostMatchedPoints);
}

void Mapper::State::predict(const std::optional<Pose2>& T_odom_base) {
  const StageTimer timer(statistics.stages.predict_s);
  prediction = estimate ? estimate->predict(motion, T_odom_base, scan.stamp_s) : motion.predict(T_odom_base);
  prediction.is_hopeless = patience.is_over();
}

// Equations (6) to (8) and (4) for a scan that can be matched; the first one is the map's origin.
MatchResult Mapper::State::match() {
  const StageTimer timer(statistics.stages.match_s);
  const auto fewest = static_cast<std::size_t>(config.scan.min_points);
  is_matched = started && points.size() >= fewest;
  if (is_matched) {
    if (estimate) {
      points = in_cells(estimate->points_to_match(scan, config.scan.min_points), config.map.resolution_m);
      thin(points, kMostMatchedPoints);
    }
    return or_on_cpu([&] { return matcher->match(points, prediction, wants_search(prediction.T_map_base)); });
  }
  MatchResult result;
  result.T_map_base = result.T_map_predicted = prediction.T_map_base;
  result.points = static_cast<std::uint32_t>(points.size());
  result.accepted = points.size() >= fewest;
  if (!result.accepted) result.doubt = Doubt::kFewPoints;
  return result;
}

// Combines the match with the wheels.
void Mapper::State::judge(MatchResult& result) {
  if (estimate) {
    kept = keep_scan(scan.points_base_m);
    estimate->take(result, is_matched, kept, [this](const Pose2& pose, const Pose2& matched) {
      return fits_about_as_well(map->host.field, points, pose, matched);
    });
  }
  if (is_matched) patience.take(result.accepted);
}

bool Mapper::State::is_keyframe(const Pose2& pose) const {
  return !started || scan.unknown_points > 0 || config.keyframe.every_scan ||
         distance(pose, last_keyframe) >= config.keyframe.distance_m ||
         turn(pose, last_keyframe) >= config.keyframe.angle_rad;
}

bool Mapper::State::wants_search(const Pose2& predicted) const {
  return config.search.when == SearchWhen::kAlways ||
         (config.search.when == SearchWhen::kKeyframe && is_keyframe(predicted));
}

// Runs before the scan is merged into the map, where it would confirm itself.
void Mapper::State::weigh(MatchResult& result) {
  if (!options.with_covariance) return;
  const MotionNoise unknown{prediction.travelled_m, prediction.turned_rad};
  certainty.carry(motion.pose(), prediction,
                  estimate ? MotionNoise{result.odometry_sigma_m, result.odometry_sigma_rad} : unknown);
  if (is_matched && result.accepted) {
    certainty.weigh(map->host.field, points, result.T_map_base, config.gate.final_m);
  }
  result.covariance = certainty.in_map(result.T_map_base.theta_rad);
}

// Equations (9) to (11) with the local field of (1), for keyframes. If nothing matched for so long that the robot must
// be somewhere new, the scan is merged there too: otherwise the map could never grow to it.
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
  const double cell_m = config.map.resolution_m;
  const std::vector<Point2> seen_m = next ? with_surfaces_closed(scan.points_base_m, cell_m) : scan.points_base_m;
  const KeyframeCells keyframe = make_keyframe_cells(in_map(seen_m, pose), cell_m, config.map.radius_cells());
  if (next && stretch_m >= config.local.stretch_m) begin_stretch();
  for (MatchedMap* matched : {map.get(), next.get()}) {
    if (matched != nullptr) matched->host.field.grow_to_hold(keyframe.window);
  }
  if (estimate) estimate->known_surfaces().add(seen_m, pose);
  if (started) stretch_m += distance(pose, last_keyframe);
  last_keyframe = pose;
  started = true;
  ++statistics.keyframes;
  merge_into(*map, keyframe);
  if (next) merge_into(*next, keyframe);
}

// Merges on the host first, whose limit counts; if a device has no room, the CPU continues without it.
void Mapper::State::merge_into(MatchedMap& matched, const KeyframeCells& keyframe) {
  matched.host.merge(keyframe, statistics.stages);
  or_on_cpu([&] {
    if (!matched.device) return;
    matched.device->merge(keyframe, statistics.stages);
    device->flush();
  });
}

// The map begun a stretch ago becomes the one for matching, and a new one is begun.
void Mapper::State::begin_stretch() {
  auto fresh = or_on_cpu([&] { return std::make_unique<MatchedMap>(config, *cpu, device); });
  matcher.reset();
  map = std::move(next);
  next = std::move(fresh);
  or_on_cpu([this] { open_matcher(); });
  if (estimate) estimate->known_surfaces().begin_stretch();
  stretch_m = 0.0;
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
  last_pose = result.T_map_base;
}

Mapper::Mapper(const MapperConfig& config, Backend& backend, MapperOptions options)
    : state_(std::make_unique<State>(config, backend, std::move(options))) {}
Mapper::~Mapper() = default;
const MapperConfig& Mapper::config() const { return state_->config; }
const std::string& Mapper::device_loss() const { return state_->loss_text; }

const GlobalField& Mapper::field() const { return state_->map->host.field; }
LoopClosing* Mapper::loops() const { return state_->loops.get(); }

std::vector<std::uint16_t> Mapper::download_device_cells() {
  state_->require_matcher();
  return state_->map->matched().download();
}

MapperStatistics Mapper::statistics() const {
  MapperStatistics statistics = state_->statistics;
  statistics.dispatches += state_->at_work->dispatch_count();
  statistics.submissions += state_->at_work->submit_count();
  statistics.device += state_->at_work->work() - state_->work_before;
  return statistics;
}

MatchResult Mapper::process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  return process({.stamp_s = scan.stamp_s, .points_base_m = state_->scan_points.of(scan)}, T_odom_base);
}

MatchResult Mapper::process(PointScan scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  s.require_matcher();
  s.see(std::move(scan));
  s.predict(T_odom_base);          // (5)
  MatchResult result = s.match();  // (6), (7), (8), (4)
  s.judge(result);
  s.weigh(result);
  s.motion.correct(result.T_map_base, result.accepted);
  s.update_map(result);  // (1), (9), (10), (11)
  s.count(result);
  result.stamp_s = s.scan.stamp_s;
  if (s.loops) s.loops->take(s.kept, result);
  return result;
}

}  // namespace gdtslam
