#include "gdtslam/mapping/nodding_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "level_scan.hpp"
#include "path_smoother.hpp"
#include "pose_path.hpp"

namespace gdtslam {
namespace {

// Matches of a robot that stands scatter by less than this.
constexpr double kShake_m = 0.04;
constexpr double kShake_rad = 0.015;

constexpr std::size_t kMostHeld = 20000;

/// A scan that waits for the fix behind it.
struct Held {
  NoddingScan scan;
  std::uint32_t index = 0;
  std::optional<MatchResult> match;
  Pose2 T_odom_base;                        ///< the last known where the log has none
  std::optional<Odometry> odometry_before;  ///< of the scan before
  double step_s = 0.0;                      ///< since the scan before; 0 where the clock was set
  [[nodiscard]] double stamp_s() const { return scan.record.scan.stamp_s; }
};

struct ElevationRange {
  double low_rad = std::numeric_limits<double>::infinity();
  double high_rad = -std::numeric_limits<double>::infinity();
  void take(double elevation_rad) {
    low_rad = std::min(low_rad, elevation_rad);
    high_rad = std::max(high_rad, elevation_rad);
  }
};

ElevationRange elevations_of(const NoddingScan& scan, const ElevationTable& table) {
  ElevationRange range;
  for (const PhaseKnot& knot : scan.knots) range.take(table.elevation_rad(knot.phase));
  return range;
}

AssemblyLimits limits_of(const MapperConfig& config, const NoddingConfig& nodding) {
  return {.min_range_m = config.scan.min_range_m, .max_range_m = config.scan.max_range_m, .form = nodding.form};
}

std::string degrees(double angle_rad) {
  const double tenths = std::round(deg_from_rad(angle_rad) * 10.0) / 10.0;
  std::string text = std::to_string(tenths);
  return text.substr(0, text.find('.') + 2);
}

}  // namespace

struct NoddingMapper::State {
  State(const NoddingConfig& nodding, const NoddingScanner& of_scans, Mapper& two_d, Backend& backend, CloudSink& cloud,
        PoseSink pose_sink, MapperOptions options)
      : config(nodding),
        scanner(of_scans),
        mapper(two_d),
        assembler(of_scans, limits_of(two_d.config(), nodding), backend, cloud),
        poses(std::move(pose_sink)),
        on_failure(std::move(options)) {}

  [[nodiscard]] bool is_horizontal(const ElevationRange& range) const;
  void note_stroke(const NoddingScan& scan);
  void fix(Held held);
  std::vector<PoseFix> place(const PoseFix& next);
  Pose2 rested(const Pose2& T_map_matched, const std::optional<Pose2>& T_odom);
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
  Mapper& mapper;
  std::unique_ptr<Backend> fallback;  // must outlive the assembler
  SweepAssembler assembler;
  PoseSink poses;
  MapperOptions on_failure;
  NoddingStatistics statistics;
  std::vector<std::string> warnings;

  std::deque<Held> held;                  // the last fix's scan, where there is one, and all after it
  std::optional<PoseFix> last_fix;        // belongs to held.front()
  std::optional<PoseFix> before_held;     // pose of the scan before held.front()
  std::optional<Odometry> last_odometry;  // of the scan before the one in hand
  ElevationRange seen;
  double last_elevation_rad = 0.0;
  int stroke = 0;  // +1 up, -1 down
  std::uint32_t scans = 0;
  double blind_s = 0.0;  // from held.front() to held.back()
  std::optional<double> last_stamp_s;
  bool is_blind_reported = false;
  bool is_odometry_dead = false;
};

// A device that fails is left for the CPU where that is allowed; what was queued is done again there.
template <class Action>
void NoddingMapper::State::on_device(const Action& action) {
  try {
    action();
  } catch (const DeviceError& error) {
    if (!on_failure.fall_back || fallback) throw;
    if (on_failure.warn) on_failure.warn(std::string(error.what()) + "; the cloud goes on with the CPU");
    fallback = make_cpu_backend(on_failure.cpu);
    assembler.use_backend(*fallback);
    assembler.flush();
  }
}

bool NoddingMapper::State::is_horizontal(const ElevationRange& range) const {
  return range.low_rad >= -config.horizontal_rad && range.high_rad <= config.horizontal_rad;
}

// A stroke ends where the elevation turns by more than the tolerance of horizontal is wide.
void NoddingMapper::State::note_stroke(const NoddingScan& scan) {
  const double elevation = scanner.table.elevation_rad(scan.knots.back().phase);
  const double step = elevation - last_elevation_rad;
  if (stroke != 0 && step * stroke >= 0.0) {
    last_elevation_rad = elevation;
  } else if (std::fabs(step) > 2.0 * config.horizontal_rad || (stroke == 0 && step != 0.0)) {
    stroke = step > 0.0 ? 1 : -1;
    last_elevation_rad = elevation;
    ++statistics.sweeps;
  }
}

// A robot whose wheels have not turned since the last fix stands where it stood; matching again would only shake it by
// the error of a match. Odometry that stands still while the matches move is none, and counts no more.
Pose2 NoddingMapper::State::rested(const Pose2& T_map_matched, const std::optional<Pose2>& T_odom) {
  if (!last_fix || !T_odom || is_odometry_dead || !(*T_odom == last_fix->T_odom_base)) return T_map_matched;
  const Pose2 moved = between(last_fix->T_map_base, T_map_matched);
  if (moved.translation().norm() <= kShake_m && std::fabs(moved.theta_rad) <= kShake_rad) return last_fix->T_map_base;
  is_odometry_dead = true;
  return T_map_matched;
}

// Figure 10, the horizontal scans: the 2D system of figure 5 fixes the pose, and with it those of the scans before.
void NoddingMapper::State::fix(Held scan) {
  const ScanRecord& record = scan.scan.record;
  scan.match =
      mapper.process(level_points(scan.scan, scanner, mapper.config().scan, last_odometry), record.T_odom_base);
  const Pose2 T_map_base = rested(scan.match->T_map_base, record.T_odom_base);
  ++statistics.fixes;
  const PoseFix fix{scan.stamp_s(), T_map_base, scan.T_odom_base};
  close_segment(fix);
  held.push_back(std::move(scan));
  last_fix = fix;
  blind_s = 0.0;
  is_blind_reported = false;
}

// The scans between two fixes, (13); where the odometry leads, the walls that they see correct it.
std::vector<PoseFix> NoddingMapper::State::place(const PoseFix& next) {
  std::vector<PoseFix> inner;
  for (std::size_t k = 1; k < held.size(); ++k) inner.push_back({held[k].stamp_s(), {}, held[k].T_odom_base});
  place_between(config.interpolation, *last_fix, next, inner);
  if (config.interpolation == PoseInterpolation::kOdometry && config.smoother.is_on) {
    const StageTimer timer(statistics.smooth_s);
    const HeightBand band{config.smoother.above_floor_m - scanner.mount.height_m, config.smoother.band_up_m};
    const auto points_of_scan = [&](std::size_t k) {
      const Held& scan = held[k + 1];
      if (scan.scan.knots.empty()) return std::vector<Point2>{};
      return level_points(scan.scan, scanner, mapper.config().scan, scan.odometry_before, band).points_base_m;
    };
    statistics.smoothed += smooth_path(config.smoother, mapper.field(), *last_fix, next, inner, points_of_scan);
  }
  return inner;
}

// All scans that wait get their poses between the fix before them and this one, (13), and their points. Before the
// first fix only the odometry knows, backwards from it.
void NoddingMapper::State::close_segment(const PoseFix& next) {
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

// Poses and points of the first `count` scans, whose nodes in the path follow the one of the scan before them.
void NoddingMapper::State::emit(std::size_t count, const PosePath& path) {
  const StageTimer timer(statistics.assemble_s);
  const std::size_t first = before_held ? 1 : 0;
  const Pose2 T_map_fix = path.node(first).T_map_base;
  for (std::size_t k = 0; k < count; ++k) {
    const PoseFix& node = path.node(first + k);
    poses({held[k].index, node.stamp_s, node.T_map_base, held[k].match}, held[k].scan);
    if (!held[k].scan.knots.empty()) {
      const std::vector<PoseKnot> knots = path.knots(first + k, held[k].scan.knots, T_map_fix);
      on_device([&] { assembler.add(held[k].scan, held[k].index, T_map_fix, knots); });
    }
  }
  before_held = path.node(first + count - 1);
  held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(count));
}

// A clock that stands still must not make what waits grow for ever.
bool NoddingMapper::State::is_blind_too_long() const {
  return held.size() > 1 && (blind_s > config.max_blind_s || held.size() > kMostHeld);
}

// From the last fix on, poses by odometry for all scans that wait.
PosePath NoddingMapper::State::path_by_odometry() const {
  PosePath path;
  if (before_held) path.append(*before_held);
  path.append(*last_fix);
  for (std::size_t k = 1; k < held.size(); ++k) {
    path.append(by_odometry(*last_fix, held[k].stamp_s(), held[k].T_odom_base));
  }
  return path;
}

// Without a horizontal scan for long the odometry alone says where the robot is. Before the first fix not even that is
// known: the oldest scans go.
void NoddingMapper::State::dead_reckon() {
  if (!is_blind_reported) {
    warnings.push_back("no horizontal scan for more than " + std::to_string(std::lround(config.max_blind_s)) +
                       " s before scan " + std::to_string(held.back().index) +
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
  statistics.by_odometry += count - 1;
  last_fix = PoseFix{path.last().stamp_s, path.last().T_map_base, path.last().T_odom_base};
  blind_s = 0.0;
  emit(count, path);
}

// The log has ended: what waits is posed by odometry.
void NoddingMapper::State::close_log() {
  const PosePath path = path_by_odometry();
  statistics.by_odometry += held.size() - 1;
  emit(held.size(), path);
}

NoddingMapper::NoddingMapper(const NoddingConfig& config, const NoddingScanner& scanner, Mapper& mapper,
                             Backend& backend, CloudSink& cloud, PoseSink poses, MapperOptions on_failure)
    : state_(
          std::make_unique<State>(config, scanner, mapper, backend, cloud, std::move(poses), std::move(on_failure))) {}
NoddingMapper::~NoddingMapper() = default;
const NoddingStatistics& NoddingMapper::statistics() const {
  state_->statistics.points = state_->assembler.points();
  return state_->statistics;
}
const std::vector<std::string>& NoddingMapper::warnings() const { return state_->warnings; }

void NoddingMapper::process(NoddingScan scan) {
  State& s = *state_;
  const std::optional<Pose2> T_odom = scan.record.T_odom_base;
  const double stamp_s = scan.record.scan.stamp_s;
  const double step_s = stamp_s - s.last_stamp_s.value_or(stamp_s);
  Held held{std::move(scan), s.scans++, std::nullopt, {}, s.last_odometry, 0.0};
  if (step_s > 0.0 && step_s <= s.config.max_blind_s) held.step_s = step_s;
  s.last_stamp_s = stamp_s;
  held.T_odom_base = T_odom.value_or(s.last_odometry ? s.last_odometry->T_odom_base : Pose2{});
  bool horizontal = false;
  if (held.scan.knots.empty()) {
    ++s.statistics.without_nod;
  } else {
    const ElevationRange range = elevations_of(held.scan, s.scanner.table);
    s.seen.take(range.low_rad);
    s.seen.take(range.high_rad);
    s.note_stroke(held.scan);
    horizontal = s.is_horizontal(range);
  }
  if (horizontal) {
    s.fix(std::move(held));
  } else {
    if (!s.held.empty()) s.blind_s += held.step_s;
    s.held.push_back(std::move(held));
    if (s.is_blind_too_long()) s.dead_reckon();
  }
  if (T_odom) s.last_odometry = Odometry{stamp_s, *T_odom};
}

void NoddingMapper::finish() {
  State& s = *state_;
  if (!s.last_fix) {
    if (s.statistics.without_nod == s.scans) {
      throw InputError("no scan has a known elevation: no ENCODER or TILT message covers one");
    }
    throw InputError("no scan is horizontal, so none can be placed: elevations go from " + degrees(s.seen.low_rad) +
                     " to " + degrees(s.seen.high_rad) + " deg, the tolerance nod.horizontal is " +
                     degrees(s.config.horizontal_rad) + " deg; is the linkage the right one?");
  }
  s.close_log();
  s.on_device([&] { s.assembler.flush(); });
}

}  // namespace gdtslam
