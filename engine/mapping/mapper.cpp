#include "gdtslam/mapping/mapper.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/mapping/cost/fit.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/mapping/match/motion_estimate.hpp"
#include "engine/mapping/match/motion_model.hpp"
#include "engine/mapping/match/patience.hpp"
#include "engine/mapping/match/pose_certainty.hpp"
#include "engine/mapping/match/thinned_points.hpp"
#include "engine/mapping/surface/closed_surfaces.hpp"
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

// Map cells that a scan's points may come to lie in, however it is turned, within the widest window.
CellBox reach_of(const std::vector<Point2>& points_base_m, const Pose2& pose, const MapperConfig& config) {
  double range_m = 0.0;
  for (const Point2& point : points_base_m) range_m = std::max(range_m, point.norm());
  const double reach_m = range_m + config.search.max_half_m;
  const Eigen::Vector2d at_m = pose.translation();
  return {map_cell_of(at_m - Eigen::Vector2d(reach_m, reach_m), config.map.resolution_m) - CellOffset{1, 1},
          map_cell_of(at_m + Eigen::Vector2d(reach_m, reach_m), config.map.resolution_m) + CellOffset{2, 2}};
}

/// A map on the host and, where its matcher works on a device, there too.
struct PlacedMap {
  PlacedMap(const MapperConfig& config, Backend& cpu) : host(config, cpu) {}
  // Where it is on the CPU alone it may be larger than the memory.
  void place_on(const MapperConfig& config, Backend* on_device, const std::string& scratch_folder) {
    if (on_device != nullptr) return static_cast<void>(device.emplace(config, *on_device, host));
    constexpr double kMostCells = 12000.0;  // for a scan to see little beside the piece that is kept near
    const double reach_m = config.scan.max_range_m + config.search.max_half_m;
    if (reach_m / config.map.resolution_m <= kMostCells) host.field.keep_near(scratch_folder);
  }
  [[nodiscard]] const GlobalField& matched() const { return device ? device->field() : host.field; }
  void leave_device(const MapperConfig& config, const std::string& scratch_folder) {
    if (device) device->update_host();
    device.reset();
    place_on(config, nullptr, scratch_folder);
  }

  KeyframeMap host;
  std::optional<DeviceMap> device;
};

bool is_cpu(const Backend& backend) { return backend.device().kind == "cpu"; }
double distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Pose2& a, const Pose2& b) { return std::fabs(wrap_angle(a.theta_rad - b.theta_rad)); }

}  // namespace

struct Mapper::State {
  State(const MapperConfig& c, Backend& backend, MapperOptions o);

  template <class Step>
  auto on_device(const Step& step);
  template <class Step>
  auto match_on_device(const Step& step);
  void require_matcher() const;
  void fall_back(const DeviceError& error);
  void open_matcher();
  void count_work_of(Backend& backend);

  void see(PointScan given);
  void predict(const std::optional<Pose2>& T_odom_base);
  void begin_match();
  MatchResult locate();
  [[nodiscard]] bool fits_as_well(const Pose2& pose, const Pose2& matched);
  [[nodiscard]] bool is_keyframe(const Pose2& pose) const;
  [[nodiscard]] bool wants_search(const Pose2& predicted) const;
  void weigh(MatchResult& result);
  void update_map(MatchResult& result);
  void merge(const Pose2& pose);
  void merge_into(PlacedMap& placed, const KeyframeCells& keyframe);
  void begin_stretch();
  void count(const MatchResult& result);

  MapperConfig config;
  MapperOptions options;
  std::unique_ptr<Backend> own_cpu;  // where the backend that was given is a device
  Backend* cpu;
  Backend* device = nullptr;        // where the matcher works, while it does
  std::unique_ptr<PlacedMap> map;   // what scans are matched with
  std::unique_ptr<PlacedMap> next;  // of local maps the one that takes its place, half a stretch younger
  double stretch_m = 0.0;           // path since `next` was begun
  std::unique_ptr<Matcher> matcher;
  std::optional<DeviceError> loss;
  std::string loss_text;
  Backend* at_work = nullptr;  // the backend that the matcher works on

  MotionModel motion;
  Patience patience;
  std::optional<MotionEstimate> estimate;  // where odometry and matches are weighed
  PoseCertainty certainty;                 // where it is asked for
  MapperStatistics statistics;
  bool started = false;
  Pose2 last_keyframe;
  Pose2 last_pose;
  double unmatched_m = 0.0;  // path since the last accepted match

  // The scan in hand, from start() to finish().
  bool in_hand = false;
  bool is_matched = false;  // there is enough of it when it is thinned, and a map
  bool is_begun = false;    // the matcher is at work on it
  PointScan scan;
  Prediction prediction;
  ScanPoints scan_points;
  std::vector<PointCells> points;  // that are matched
};

// The one place where a device may fail while it maps: what was being done is done again on the CPU, with the map as
// the host knows it and the scan in hand; or, without leave to fall back or from the CPU, the error goes to the caller.
// The device is asked for nothing after its first error.
template <class Step>
auto Mapper::State::on_device(const Step& step) {
  try {
    return step();
  } catch (const DeviceError& error) {
    fall_back(error);
  }
  return step();
}

// Where matching fails for good the scan is lost, its motion is not.
template <class Step>
auto Mapper::State::match_on_device(const Step& step) {
  try {
    return on_device(step);
  } catch (const DeviceError&) {
    motion.correct(prediction.T_map_base, false);
    throw;
  }
}

// A matcher that walks on the host has its map there, whatever the device, which then has nothing to do.
Mapper::State::State(const MapperConfig& c, Backend& backend, MapperOptions o)
    : config(checked(c)),
      options(std::move(o)),
      own_cpu(is_cpu(backend) ? nullptr : make_cpu_backend(options.cpu)),
      cpu(own_cpu ? own_cpu.get() : &backend),
      motion(config.odometry),
      scan_points(config.scan) {
  if (own_cpu && matcher_info(config.match.matcher).place == MatcherPlace::kDevice) device = &backend;
  count_work_of(device != nullptr ? backend : *cpu);
  if (config.odometry.estimate) estimate.emplace();
  map = std::make_unique<PlacedMap>(config, *cpu);
  if (config.local.stretch_m > 0.0) next = std::make_unique<PlacedMap>(config, *cpu);
  on_device([&] {
    map->place_on(config, device, options.scratch_folder);
    if (next) next->place_on(config, device, options.scratch_folder);
    open_matcher();
  });
}

void Mapper::State::open_matcher() { matcher = matcher_info(config.match.matcher).make(config, map->matched()); }

// There is no way back from the CPU: what it failed at would fail again.
void Mapper::State::fall_back(const DeviceError& error) {
  const bool was_on_cpu = at_work == cpu;
  loss = error;
  loss_text = error.what();
  matcher.reset();
  is_begun = false;
  device = nullptr;
  for (PlacedMap* placed : {map.get(), next.get()}) {
    if (placed != nullptr) placed->leave_device(config, options.scratch_folder);
  }
  count_work_of(*cpu);
  if (!options.fall_back || was_on_cpu) throw DeviceError(error);
  open_matcher();
  if (options.warn) options.warn(loss_text + "; going on with the CPU, which gives the same results");
}

// Throws the error that left the mapper without a matcher.
void Mapper::State::require_matcher() const {
  if (loss && matcher == nullptr) throw DeviceError(*loss);
}

// The counts of a mapper are those of the backends that it worked on, while it did.
void Mapper::State::count_work_of(Backend& backend) {
  if (at_work != nullptr) {
    statistics.dispatches += at_work->dispatch_count();
    statistics.submissions += at_work->submit_count();
  }
  at_work = &backend;
  statistics.dispatches -= backend.dispatch_count();
  statistics.submissions -= backend.submit_count();
}

// The returns of the scan in the robot's frame, the P of equation (6). A scan with more than a matcher takes is thinned
// for matching, not for the map.
void Mapper::State::see(PointScan given) {
  scan = std::move(given);
  points = in_cells(scan.points_base_m, config.map.resolution_m);
  points.resize(points.size() - scan.unknown_points);
  thin(points, Matcher::kMostPoints);
}

void Mapper::State::predict(const std::optional<Pose2>& T_odom_base) {
  const StageTimer timer(statistics.stages.predict_s);
  prediction = estimate ? estimate->predict(motion, T_odom_base, scan.stamp_s) : motion.predict(T_odom_base);
  prediction.is_hopeless = patience.is_over();
}

// Equations (6) to (8) and (4) for a scan that can be matched; the first one is the map's origin.
void Mapper::State::begin_match() {
  is_matched = started && points.size() >= static_cast<std::size_t>(config.scan.min_points);
  if (!is_matched) return;
  const StageTimer timer(statistics.stages.match_s);
  if (estimate) {
    points = in_cells(estimate->points_to_match(scan, config.scan.min_points), config.map.resolution_m);
    thin(points, Matcher::kMostPoints);
  }
  if (!map->device) map->host.field.come_near(reach_of(scan.points_base_m, prediction.T_map_base, config));
  matcher->start(points, prediction, wants_search(prediction.T_map_base));
  is_begun = true;
}

MatchResult Mapper::State::locate() {
  if (is_matched) {
    if (!is_begun) begin_match();  // the device had it
    const StageTimer timer(statistics.stages.match_s);
    MatchResult result = matcher->finish();
    if (map->device) map->device->take_checkpoint_piece();  // it stood in line before this scan, so it is there
    return result;
  }
  MatchResult result;
  result.T_map_base = result.T_map_predicted = prediction.T_map_base;
  result.points = static_cast<std::uint32_t>(points.size());
  result.accepted = points.size() >= static_cast<std::size_t>(config.scan.min_points);
  if (!result.accepted) result.doubt = Doubt::kFewPoints;
  return result;
}

bool Mapper::State::fits_as_well(const Pose2& pose, const Pose2& matched) {
  return match_on_device([&] { return fits_about_as_well(map->matched(), points, pose, matched); });
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

// Before the scan goes into the map, in which it would confirm itself.
void Mapper::State::weigh(MatchResult& result) {
  if (!options.with_covariance || map->device) return;
  const MotionNoise unknown{prediction.travelled_m, prediction.turned_rad};
  certainty.carry(motion.pose(), prediction,
                  estimate ? MotionNoise{result.odometry_sigma_m, result.odometry_sigma_rad} : unknown);
  if (is_matched && result.accepted) {
    certainty.weigh(map->host.field, points, result.T_map_base, config.gate.final_m);
  }
  result.covariance = certainty.in_map(result.T_map_base.theta_rad);
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

// A keyframe that was noted is in the map, whatever becomes of the device, unless its map would become too large.
void Mapper::State::merge(const Pose2& pose) {
  const double cell_m = config.map.resolution_m;
  const std::vector<Point2> seen_m = next ? with_surfaces_closed(scan.points_base_m, cell_m) : scan.points_base_m;
  const KeyframeCells keyframe = keyframe_of(in_map(seen_m, pose), cell_m, config.map.radius_cells());
  if (next && stretch_m >= config.local.stretch_m) begin_stretch();
  for (PlacedMap* placed : {map.get(), next.get()}) {
    if (placed != nullptr) placed->host.field.grow_to_hold(keyframe.window);
  }
  if (estimate) estimate->known_surfaces().add(seen_m, pose);
  if (started) stretch_m += distance(pose, last_keyframe);
  last_keyframe = pose;
  started = true;
  ++statistics.keyframes;
  merge_into(*map, keyframe);
  if (next) merge_into(*next, keyframe);
}

void Mapper::State::merge_into(PlacedMap& placed, const KeyframeCells& keyframe) {
  if (!placed.device) return placed.host.merge(keyframe, statistics.stages);
  placed.device->note(keyframe);
  on_device([&] {
    if (placed.device) placed.device->merge(statistics.stages);
  });
}

// The map that was begun a stretch ago has become the one to match with, and a new one is begun.
void Mapper::State::begin_stretch() {
  auto fresh = std::make_unique<PlacedMap>(config, *cpu);
  on_device([&] { fresh->place_on(config, device, options.scratch_folder); });
  matcher.reset();
  map = std::move(next);
  next = std::move(fresh);
  on_device([this] { open_matcher(); });
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
}

Mapper::Mapper(const MapperConfig& config, Backend& backend, MapperOptions options)
    : state_(std::make_unique<State>(config, backend, std::move(options))) {}
Mapper::~Mapper() = default;
const MapperConfig& Mapper::config() const { return state_->config; }
const std::string& Mapper::device_loss() const { return state_->loss_text; }

const GlobalField& Mapper::field() const {
  if (state_->map->device) state_->map->device->update_host();
  return state_->map->host.field;
}

std::vector<std::uint16_t> Mapper::download_device_cells() {
  state_->require_matcher();
  return state_->map->matched().download();
}

MapperStatistics Mapper::statistics() const {
  MapperStatistics statistics = state_->statistics;
  statistics.dispatches += state_->at_work->dispatch_count();
  statistics.submissions += state_->at_work->submit_count();
  return statistics;
}

void Mapper::start(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  start({.stamp_s = scan.stamp_s, .points_base_m = state_->scan_points.of(scan)}, T_odom_base);
}

void Mapper::start(PointScan scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  assert(!s.in_hand);
  s.require_matcher();
  s.see(std::move(scan));
  s.predict(T_odom_base);                        // (5)
  s.match_on_device([&s] { s.begin_match(); });  // (6), (7), (8), (4)
  s.in_hand = true;
}

MatchResult Mapper::finish() {
  State& s = *state_;
  assert(s.in_hand);
  s.in_hand = false;
  MatchResult result = s.match_on_device([&s] { return s.locate(); });
  if (s.estimate) {
    s.estimate->take(result, s.is_matched, s.scan.points_base_m,
                     [&s](const Pose2& pose, const Pose2& matched) { return s.fits_as_well(pose, matched); });
  }
  if (s.is_matched) s.patience.take(result.accepted);
  s.weigh(result);
  s.motion.correct(result.T_map_base, result.accepted);
  s.update_map(result);  // (1), (9), (10), (11)
  s.count(result);
  s.last_pose = result.T_map_base;
  result.stamp_s = s.scan.stamp_s;
  return result;
}

}  // namespace gdtslam
