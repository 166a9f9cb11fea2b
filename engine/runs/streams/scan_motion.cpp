#include "scan_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr double kEnoughTurn_rad = 20.0;
constexpr std::size_t kMostScans = 3000;
constexpr double kWindow_s = 2.0;       // longer than the delay of odometry
constexpr double kTurn_rad = 0.1;       // least turn of a window that counts
constexpr double kStraight_m = 0.3;     // length of a stretch, more than the error of a match
constexpr double kStraight_rad = 0.15;  // sum of all turns in it
constexpr double kSnap_rad = 5.0 * kPi / 180.0;

// This look needs turns, not the best map: one wrong match among many does no harm. Only the last motion predicts the
// next scan, so windows are wide; they are searched only for suspect matches, coarsely and once.
MapperConfig config_of_look(MapperConfig config) {
  constexpr double kCoarser = 2.0;
  config.odometry.estimate = true;
  config.search.when = std::min(config.search.when, SearchWhen::kSuspect);
  config.search.attempts = std::min(config.search.attempts, 1);
  config.search.step_m *= kCoarser;
  config.search.step_rad *= kCoarser;
  return config;
}

bool has_same_layout(const LaserScan& scan, const LaserScan& first) {
  return scan.first_bearing_rad == first.first_bearing_rad && scan.bearing_step_rad == first.bearing_step_rad &&
         scan.T_base_laser == first.T_base_laser;
}

// A whole number of quarter turns if it is near one: nobody mounts a laser 1 degree off on purpose.
double snapped(double angle_rad) {
  const double quarter = std::floor(angle_rad / (0.5 * kPi) + 0.5) * 0.5 * kPi;
  return std::fabs(angle_rad - quarter) < kSnap_rad ? quarter : angle_rad;
}

bool are_times_stated(const ReadOptions& options) {
  return options.first_beam_after_s || options.beam_period_s || !options.deskew;
}

std::string degrees(double angle_rad) { return fmt::format("{:.9g}deg", deg_from_rad(angle_rad)); }

LogFinding mirrored_laser(const TurnAgreement& turns, const MotionByScans& motion) {
  const LaserScan& scan = motion.first_scan;
  return {.what = "scans and wheels turn opposite ways: laser upside down or mirrored, or wheels swapped",
          .evidence = fmt::format("in {} turns the scans turn {:.2f} times as far as the wheels, correlation {:.2f}",
                                  turns.turns, turns.slope, turns.correlation),
          .options = motion.has_one_layout
                         ? fmt::format("--set log.bearings=stated --set log.bearing_step={} --set log.first_bearing={}",
                                       degrees(-scan.bearing_step_rad), degrees(-scan.first_bearing_rad))
                         : std::string()};
}

std::string direction_text(double left_rad) {
  const double off_deg = std::fabs(deg_from_rad(left_rad));
  if (off_deg > 150.0) return "backward where the wheels go forward";
  return fmt::format("{:.0f} deg to the {} of where the wheels go", off_deg, left_rad > 0.0 ? "left" : "right");
}

LogFinding turned_mount(const DirectionAgreement& directions, const MotionByScans& motion) {
  const Pose2& mount = motion.first_scan.T_base_laser;
  const double off_rad = snapped(directions.left_rad);
  return {.what = fmt::format("by its scans the laser moves {}: its mount is turned by {:.0f} deg",
                              direction_text(directions.left_rad), std::fabs(deg_from_rad(off_rad))),
          .evidence = fmt::format("{:.1f} deg over {:.1f} m of straight path, concentration {:.2f}",
                                  deg_from_rad(directions.left_rad), directions.path_m, directions.concentration),
          .options = motion.has_one_layout
                         ? fmt::format("--set log.mount=stated --set log.mount_x={:.6g}m --set log.mount_y={:.6g}m "
                                       "--set log.mount_angle={}",
                                       mount.x_m, mount.y_m, degrees(wrap_angle(mount.theta_rad - off_rad)))
                         : std::string()};
}

}  // namespace

MotionByScans motion_by_scans(const std::string& log, const ReadOptions& options, const ScanRange& range,
                              const MapperConfig& mapper, const std::function<bool()>& stop) {
  MotionByScans motion;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(log, ignored) && !std::filesystem::is_directory(log, ignored)) return motion;
  const MapperConfig config = config_of_look(mapper);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  double turned_rad = 0.0;
  std::optional<std::size_t> laser;
  BeamTimesFit beam_times;
  try {
    Mapper by_scans(config, *cpu);
    ScanStream scans({log}, options, {.skip = range.skip, .count = std::min<std::uint64_t>(range.count, kMostScans)});
    while (turned_rad < kEnoughTurn_rad && !stop()) {
      std::optional<ScanRecord> record = scans.next();
      if (!record) break;
      if (!laser) {
        laser = record->laser;
        motion.first_scan = record->scan;
        motion.first_scan.ranges_m.clear();
      }
      motion.has_one_layout = motion.has_one_layout && has_same_layout(record->scan, motion.first_scan);
      if (record->laser != *laser) continue;
      const MatchResult result = by_scans.process(record->scan, std::nullopt);
      if (result.accepted) beam_times.add(record->scan, result.T_map_base);
      if (!record->T_odom_base || !result.accepted) continue;
      if (!motion.motions.empty()) {
        const double before_rad = motion.motions.back().T_scans_base.theta_rad;
        turned_rad += std::fabs(wrap_angle(result.T_map_base.theta_rad - before_rad));
      }
      motion.motions.push_back({result.stamp_s, *record->T_odom_base, result.T_map_base});
    }
  } catch (const Error&) {  // the run itself reports the fault of the log
    return {};
  }
  if (!are_times_stated(options)) motion.beam_times = beam_times.fit(mapper.scan);
  return motion;
}

bool TurnAgreement::is_opposite() const {
  return turns >= 5 && turned_rad > 3.0 && correlation < -0.9 && slope < -0.67 && slope > -1.5;
}

TurnAgreement turn_agreement(std::span<const TimedMotion> motions) {
  TurnAgreement found;
  double wheels_rad = 0.0;  // in the current window
  double scans_rad = 0.0;
  double sq_wheels = 0.0;
  double sq_scans = 0.0;
  double products = 0.0;
  std::size_t from = 0;
  for (std::size_t i = 1; i < motions.size(); ++i) {
    wheels_rad += wrap_angle(motions[i].T_odom_base.theta_rad - motions[i - 1].T_odom_base.theta_rad);
    scans_rad += wrap_angle(motions[i].T_scans_base.theta_rad - motions[i - 1].T_scans_base.theta_rad);
    if (std::fabs(motions[i].stamp_s - motions[from].stamp_s) < kWindow_s) continue;
    sq_wheels += wheels_rad * wheels_rad;
    sq_scans += scans_rad * scans_rad;
    products += wheels_rad * scans_rad;
    found.turned_rad += std::fabs(wheels_rad);
    if (std::fabs(wheels_rad) > kTurn_rad) ++found.turns;
    wheels_rad = scans_rad = 0.0;
    from = i;
  }
  if (!(sq_wheels > 0.0 && sq_scans > 0.0)) return found;
  found.slope = products / sq_wheels;
  found.correlation = products / std::sqrt(sq_wheels * sq_scans);
  return found;
}

bool DirectionAgreement::is_turned() const {
  constexpr double kLeastOff_rad = 30.0 * kPi / 180.0;
  return path_m > 3.0 && concentration > 0.95 && stretch > 0.7 && stretch < 1.4 && std::fabs(left_rad) > kLeastOff_rad;
}

DirectionAgreement direction_agreement(std::span<const TimedMotion> motions) {
  DirectionAgreement found;
  Point2 sum = Point2::Zero();  // path by the scans, x axis along the path by the wheels
  double scans_m = 0.0;
  double turned_rad = 0.0;
  std::size_t from = 0;
  for (std::size_t i = 1; i < motions.size(); ++i) {
    turned_rad += std::fabs(wrap_angle(motions[i].T_odom_base.theta_rad - motions[i - 1].T_odom_base.theta_rad));
    const Point2 wheels = between(motions[from].T_odom_base, motions[i].T_odom_base).translation();
    const double length_m = wheels.norm();
    if (turned_rad <= kStraight_rad && length_m < kStraight_m) continue;
    if (turned_rad <= kStraight_rad) {
      const Point2 scans = between(motions[from].T_scans_base, motions[i].T_scans_base).translation();
      sum += Point2(scans.dot(wheels), wheels.x() * scans.y() - wheels.y() * scans.x()) / length_m;
      scans_m += scans.norm();
      found.path_m += length_m;
    }
    turned_rad = 0.0;
    from = i;
  }
  if (!(scans_m > 0.0)) return found;
  found.left_rad = atan2(sum.y(), sum.x());
  found.concentration = sum.norm() / scans_m;
  found.stretch = scans_m / found.path_m;
  return found;
}

std::vector<LogFinding> motion_findings(const MotionByScans& motion) {
  std::vector<LogFinding> faults;
  const TurnAgreement turns = turn_agreement(motion.motions);
  const DirectionAgreement directions = direction_agreement(motion.motions);
  if (turns.is_opposite()) {
    faults.push_back(mirrored_laser(turns, motion));
  } else if (directions.is_turned()) {
    faults.push_back(turned_mount(directions, motion));
  }
  if (motion.beam_times && motion.beam_times->stands_out()) {
    faults.push_back(motion.beam_times->finding());
    if (!motion.has_one_layout) faults.back().options.clear();
  }
  return faults;
}

std::span<const TimedMotion> MotionLook::faultless() const {
  const bool is_right =
      std::all_of(faults.begin(), faults.end(), [](const LogFinding& fault) { return fault.is_mended; });
  return is_right ? std::span(motion.motions) : std::span<const TimedMotion>();
}

MotionLook look_at_motion_by_scans(const std::string& log, ReadOptions& options, const ScanRange& range,
                                   const MapperConfig& mapper, const std::function<bool()>& stop) {
  MotionLook look{.motion = motion_by_scans(log, options, range, mapper, stop), .faults = {}};
  const std::optional<BeamTimes> times = look.motion.beam_times;
  look.faults = motion_findings(look.motion);
  if (!times || !times->stands_out() || !look.motion.has_one_layout) return look;
  LogFinding mended = look.faults.back();
  mended.is_mended = true;
  times->state_in(options);
  look.motion = motion_by_scans(log, options, range, mapper, stop);
  look.faults = motion_findings(look.motion);
  look.faults.push_back(std::move(mended));
  return look;
}

}  // namespace gdtslam
