#include "scan_placer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <utility>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"
#include "horizontal_scans.hpp"
#include "path_noise.hpp"
#include "path_smoother.hpp"
#include "pose_path.hpp"

namespace gdtslam {
namespace {

// Largest scatter of the matches of a standing robot.
constexpr double kShake_m = 0.04;
constexpr double kShake_rad = 0.015;

constexpr std::size_t kMostHeld = 20000;

/// A scan that waits for the next fix.
struct Held {
  NoddingScan scan;
  std::uint32_t index = 0;
  std::optional<MatchResult> match;
  Pose2 T_odom_base;                        ///< the last known one if the log has none
  std::optional<Odometry> odometry_before;  ///< odometry of the scan before
  double step_s = 0.0;                      ///< since the scan before; 0 if the clock was set
  [[nodiscard]] double stamp_s() const { return scan.record.scan.stamp_s; }
};

AssemblyLimits assembly_limits(const ScanConfig& valid, const NoddingConfig& nodding) {
  return {.min_range_m = valid.min_range_m, .max_range_m = valid.max_range_m, .form = nodding.form};
}

}  // namespace

struct ScanPlacer::State {
  State(const NoddingConfig& nodding, const NoddingScanner& of_scans, const ScanConfig& valid_ranges,
        FieldSource field_source, PlacedScans placed_scans)
      : config(nodding),
        scanner(of_scans),
        valid(valid_ranges),
        field(std::move(field_source)),
        placed(std::move(placed_scans)),
        assembler(of_scans, assembly_limits(valid_ranges, nodding), placed.backend, placed.cloud),
        noise(nodding.smoother) {}

  Held hold(NoddingScan scan);
  void begin_odometry(const Pose2& T_odom_base);
  void wait(Held scan);
  std::vector<PoseFix> place(const PoseFix& next);
  void learn(const PoseFix& next, std::span<const PoseFix> inner, const PointsOfNode& node_points);
  Pose2 rested(const Pose2& T_map_fixed, const std::optional<Pose2>& T_odom);
  void close_segment(const PoseFix& next);
  void dead_reckon();
  void emit(std::size_t count, const PosePath& path);
  template <class Action>
  void on_device(const Action& action);
  [[nodiscard]] PosePath path_by_odometry() const;
  void close_log();
  [[nodiscard]] bool is_blind_too_long() const;

  NoddingConfig config;
  NoddingScanner scanner;
  ScanConfig valid;
  FieldSource field;
  PlacedScans placed;
  std::unique_ptr<Backend> fallback;  // must outlive the assembler
  SweepAssembler assembler;
  NoddingStatistics statistics;
  PathNoise noise;
  std::vector<std::string> warnings;

  std::deque<Held> held;                  // the last fix's scan, if there is one, and all after it
  std::optional<PoseFix> last_fix;        // belongs to held.front()
  std::optional<PoseFix> before_held;     // pose of the scan before held.front()
  std::optional<Odometry> last_odometry;  // odometry of the scan before the current one
  std::uint32_t scans = 0;
  double blind_s = 0.0;  // from held.front() to held.back()
  std::optional<double> last_stamp_s;
  bool is_blind_reported = false;
  bool is_odometry_dead = false;
  bool has_fix_odometry = false;  // at last_fix
  bool with_points = true;
};

// If the device fails and it is allowed, the CPU takes over; queued work is repeated there.
template <class Action>
void ScanPlacer::State::on_device(const Action& action) {
  try {
    action();
  } catch (const DeviceError& error) {
    if (!placed.on_failure.fall_back || fallback) throw;
    if (placed.on_failure.warn) {
      placed.on_failure.warn(std::string(error.what()) + "; the cloud goes on with the CPU");
    }
    fallback = make_cpu_backend(placed.on_failure.cpu);
    assembler.use_backend(*fallback);
    assembler.flush();
  }
}

// A robot whose wheels have not turned since the last fix keeps its pose; a new fix would only add the error of a
// match. If the odometry stands still while the fixes move, it counts as missing from then on.
Pose2 ScanPlacer::State::rested(const Pose2& T_map_fixed, const std::optional<Pose2>& T_odom) {
  if (!has_fix_odometry || !T_odom || is_odometry_dead || !(*T_odom == last_fix->T_odom_base)) return T_map_fixed;
  const Pose2 moved = between(last_fix->T_map_base, T_map_fixed);
  if (translation_length(moved) <= kShake_m && std::fabs(moved.theta_rad) <= kShake_rad) return last_fix->T_map_base;
  is_odometry_dead = true;
  return T_map_fixed;
}

// The origin of the odometry frame was unknown before: until then the robot counts as standing.
void ScanPlacer::State::begin_odometry(const Pose2& T_odom_base) {
  for (Held& scan : held) scan.T_odom_base = T_odom_base;
  if (last_fix) last_fix->T_odom_base = T_odom_base;
  if (before_held) before_held->T_odom_base = T_odom_base;
}

Held ScanPlacer::State::hold(NoddingScan scan) {
  const std::optional<Pose2> T_odom = scan.record.T_odom_base;
  const double stamp_s = scan.record.scan.stamp_s;
  const double step_s = stamp_s - last_stamp_s.value_or(stamp_s);
  if (scan.knots.empty()) ++statistics.without_nod;
  Held one{std::move(scan), scans++, std::nullopt, {}, last_odometry, 0.0};
  if (step_s > 0.0 && step_s <= config.max_blind_s) one.step_s = step_s;
  last_stamp_s = stamp_s;
  if (T_odom && !last_odometry) begin_odometry(*T_odom);
  one.T_odom_base = T_odom.value_or(last_odometry ? last_odometry->T_odom_base : Pose2{});
  if (T_odom) last_odometry = Odometry{stamp_s, *T_odom};
  return one;
}

void ScanPlacer::State::wait(Held scan) {
  if (!held.empty()) blind_s += scan.step_s;
  held.push_back(std::move(scan));
  if (is_blind_too_long()) dead_reckon();
}

// The scans between two fixes, (13); with odometry, the walls that they see correct it.
std::vector<PoseFix> ScanPlacer::State::place(const PoseFix& next) {
  std::vector<PoseFix> inner;
  inner.reserve(held.size());
  for (std::size_t k = 1; k < held.size(); ++k) inner.push_back({held[k].stamp_s(), {}, held[k].T_odom_base});
  place_between(config.interpolation, *last_fix, next, inner);
  if (with_points && config.interpolation == PoseInterpolation::kOdometry && config.smoother.is_on) {
    const StageTimer timer(statistics.smooth_s);
    const HeightBand band{config.smoother.above_floor_m - scanner.mount.height_m, config.smoother.band_up_m};
    const auto points_of_scan = [&](std::size_t k) {
      const Held& scan = held[k + 1];
      if (scan.scan.knots.empty()) return std::vector<Point2>{};
      return level_points(scan.scan, scanner, valid, scan.odometry_before, band).points_base_m;
    };
    learn(next, inner, points_of_scan);
    statistics.smoothed += smooth_path(noise.found(), field(), *last_fix, next, inner, points_of_scan);
  }
  return inner;
}

// Estimates the noise of wheels and points from this stretch; only the points half way count, which are farthest from
// both fixes.
void ScanPlacer::State::learn(const PoseFix& next, std::span<const PoseFix> inner, const PointsOfNode& node_points) {
  noise.take_closing(*last_fix, next, inner);
  if (inner.empty()) return;
  const std::size_t middle = inner.size() / 2;
  const PointsView view = view_from(config.smoother, field(), inner[middle].T_map_base, node_points(middle));
  noise.take_view(*last_fix, next, inner, middle, view);
}

// All waiting scans get their poses between the previous fix and this one, (13), and their points. Before the first fix
// only odometry is available, backwards from the fix.
void ScanPlacer::State::close_segment(const PoseFix& next) {
  if (held.empty()) return;
  PosePath path;
  if (before_held) path.append(*before_held);
  if (last_fix) {
    path.append(*last_fix);
    for (const PoseFix& node : place(next)) path.append(node);
    statistics.between += held.size() - 1;
  } else {
    for (const Held& scan : held) path.append(by_odometry(next, scan.stamp_s(), scan.T_odom_base));
    statistics.before_first_fix += held.size();
  }
  path.append(next);
  emit(held.size(), path);
}

// Poses and points of the first `count` scans, whose nodes in the path follow that of the previous scan.
void ScanPlacer::State::emit(std::size_t count, const PosePath& path) {
  const StageTimer timer(statistics.assemble_s);
  const std::size_t first = before_held ? 1 : 0;
  const Pose2 T_map_fix = path.node(first).T_map_base;
  for (std::size_t k = 0; k < count; ++k) {
    const PoseFix& node = path.node(first + k);
    placed.poses({held[k].index, node.stamp_s, node.T_map_base, held[k].match}, held[k].scan);
    if (with_points && !held[k].scan.knots.empty()) {
      const std::vector<PoseKnot> knots = path.knots(first + k, held[k].scan.knots, T_map_fix);
      on_device([&] { assembler.add(held[k].scan, held[k].index, T_map_fix, knots); });
    }
  }
  before_held = path.node(first + count - 1);
  held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(count));
}

// Limits the waiting scans even if the clock stands still.
bool ScanPlacer::State::is_blind_too_long() const {
  return held.size() > 1 && (blind_s > config.max_blind_s || held.size() > kMostHeld);
}

// Poses by odometry for all waiting scans, from the last fix on.
PosePath ScanPlacer::State::path_by_odometry() const {
  PosePath path;
  if (before_held) path.append(*before_held);
  path.append(*last_fix);
  for (std::size_t k = 1; k < held.size(); ++k) {
    path.append(by_odometry(*last_fix, held[k].stamp_s(), held[k].T_odom_base));
  }
  return path;
}

// After long without a horizontal scan the odometry alone gives the pose. Before the first fix there is no pose at all:
// the oldest scans are dropped.
void ScanPlacer::State::dead_reckon() {
  if (!is_blind_reported) {
    const bool is_refused =
        std::any_of(held.begin() + 1, held.end(), [](const Held& scan) { return scan.match.has_value(); });
    warnings.push_back(std::string("no horizontal scan ") + (is_refused ? "that matches " : "") + "for more than " +
                       std::to_string(std::lround(config.max_blind_s)) + " s before scan " +
                       std::to_string(held.back().index) +
                       (last_fix ? ": poses by odometry there" : ": what comes before the first is dropped") +
                       "; nod.horizontal is the tolerance");
    is_blind_reported = true;
  }
  if (!last_fix) {
    held.pop_front();
    blind_s -= held.front().step_s;
    ++statistics.dropped;
    return;
  }
  const PosePath path = path_by_odometry();
  const std::size_t count = held.size() - 1;
  statistics.by_odometry += count;  // including the last one, which serves as the fix of later scans
  last_fix = PoseFix{path.last().stamp_s, path.last().T_map_base, path.last().T_odom_base};
  has_fix_odometry = last_odometry.has_value();
  blind_s = 0.0;
  emit(count, path);
}

// The log has ended: waiting scans get poses by odometry.
void ScanPlacer::State::close_log() {
  const PosePath path = path_by_odometry();
  statistics.by_odometry += held.size() - 1;
  emit(held.size(), path);
}

ScanPlacer::ScanPlacer(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid,
                       FieldSource field, PlacedScans placed)
    : state_(std::make_unique<State>(config, scanner, valid, std::move(field), std::move(placed))) {}
ScanPlacer::~ScanPlacer() = default;

bool ScanPlacer::has_fix() const { return state_->last_fix.has_value(); }
void ScanPlacer::leave_points() { state_->with_points = false; }
const std::vector<std::string>& ScanPlacer::warnings() const { return state_->warnings; }
const NoddingStatistics& ScanPlacer::statistics() const {
  state_->statistics.points = state_->assembler.points();
  return state_->statistics;
}

void ScanPlacer::take(NoddingScan scan) { state_->wait(state_->hold(std::move(scan))); }

// This fix also determines the scans since the last one.
void ScanPlacer::take_fix(NoddingScan scan, const Pose2& T_map_base, const MatchResult& match) {
  State& s = *state_;
  const std::optional<Pose2> T_odom = scan.record.T_odom_base;
  Held held = s.hold(std::move(scan));
  held.match = match;
  if (!match.accepted && s.last_fix) return s.wait(std::move(held));
  ++s.statistics.fixes;
  const PoseFix fix{held.stamp_s(), s.rested(T_map_base, T_odom), held.T_odom_base};
  s.close_segment(fix);
  s.held.push_back(std::move(held));
  s.last_fix = fix;
  s.has_fix_odometry = s.last_odometry.has_value();
  s.blind_s = 0.0;
  s.is_blind_reported = false;
}

void ScanPlacer::finish() {
  State& s = *state_;
  s.close_log();
  s.on_device([&s] { s.assembler.flush(); });
}

}  // namespace gdtslam
