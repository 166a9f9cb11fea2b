#include "calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostBeams = 60'000;
constexpr double kBeamSpacing_rad = 1.5 * kPi / 180.0;
constexpr double kMostPoseGap_s = 0.2;  // farther from any pose of the trajectory, a beam has no pose
constexpr double kSetBack_s = 1.0;      // a larger step back means another clock
constexpr double kMostRange_m = 12.0;   // farther surfaces are sampled too thinly
constexpr double kLeastRange_m = 0.3;

/// A beam with all its data that do not depend on the linkage.
struct SelfBeam {
  double ticks = 0.0;
  double bearing_rad = 0.0;
  double range_m = 0.0;
  Pose2 T_map_level;
};

// Maps the log with the start's linkage; returns the robot's poses.
Trajectory mapped_poses(const SelfCalibrateJob& job, SelfCalibrateOutcome& found,
                        const std::function<void(double)>& progress, const std::function<bool()>& stop) {
  const std::unique_ptr<Backend> backend = make_cpu_backend(CpuOptions{.threads = 1, .isa = std::nullopt});
  const MapRequest map{.logs = job.logs, .with_map = false, .with_loops = false};
  NoddingJob nodding;
  nodding.model = job.start;
  nodding.linkage = job.start.name;
  nodding.check.is_on = false;
  ScanStream scans(job.logs, job.read, {});
  if (scans.nod_kind() != NodKind::kEncoder) {
    throw InputError({log_name(job.logs.front()), 0}, "has no ENCODER message, so there is no linkage to calibrate");
  }
  MapRun run(map, *backend, std::move(scans), &nodding);
  MapOutcome outcome = run.run([&](std::uint64_t, double share) { progress(0.9 * share); }, stop);
  if (outcome.interrupted) throw Error(ExitCode::kInterrupted, "interrupted while mapping; nothing was written");
  found.warnings = std::move(outcome.warnings);
  return std::move(outcome.trajectory);
}

std::optional<Pose2> pose_at(const Trajectory& trajectory, double stamp_s) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_s,
                                      [](const StampedPose& pose, double at_s) { return pose.stamp_s < at_s; });
  if (after == trajectory.end() || after == trajectory.begin()) {
    if (trajectory.empty()) return std::nullopt;
    const StampedPose& end = after == trajectory.begin() ? trajectory.front() : trajectory.back();
    return std::fabs(end.stamp_s - stamp_s) <= kMostPoseGap_s ? std::optional(end.T_map_base) : std::nullopt;
  }
  const StampedPose& before = *(after - 1);
  const double span_s = after->stamp_s - before.stamp_s;
  if (stamp_s - before.stamp_s > kMostPoseGap_s && after->stamp_s - stamp_s > kMostPoseGap_s) return std::nullopt;
  const double share = span_s > 0.0 ? (stamp_s - before.stamp_s) / span_s : 0.0;
  return before.T_map_base * exp_se2(share * log_se2(between(before.T_map_base, after->T_map_base)));
}

/// Poses in the order of the logs. Each log has its own clock: a new stretch begins if stamps step back.
class PosesOfLogs {
 public:
  explicit PosesOfLogs(const Trajectory& trajectory) : stretches_(1) {
    double last_s = -std::numeric_limits<double>::infinity();
    for (const StampedPose& pose : trajectory) {
      if (steps_back(last_s, pose.stamp_s)) stretches_.emplace_back();
      stretches_.back().push_back(pose);
      last_s = pose.stamp_s;
    }
    for (Trajectory& stretch : stretches_) {
      std::stable_sort(stretch.begin(), stretch.end(),
                       [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; });
    }
  }

  /// Moves to the next scan, in the order of the logs.
  void go_to_scan(double stamp_s) {
    if (steps_back(last_scan_s_, stamp_s) && now_ + 1 < stretches_.size()) ++now_;
    last_scan_s_ = stamp_s;
  }
  /// Pose at a time near that scan.
  [[nodiscard]] std::optional<Pose2> at(double stamp_s) const { return pose_at(stretches_[now_], stamp_s); }

 private:
  static bool steps_back(double from_s, double to_s) { return to_s < from_s - kSetBack_s; }

  std::vector<Trajectory> stretches_;
  std::size_t now_ = 0;
  double last_scan_s_ = -std::numeric_limits<double>::infinity();
};

/// Collects all beams at first, and drops every second one whenever there are too many.
class BeamCollector {
 public:
  explicit BeamCollector(const calib::SweepModel& model, const Trajectory& trajectory)
      : model_(model), poses_(trajectory) {}

  void add(const NoddingScan& nodding) {
    const LaserScan& scan = nodding.record.scan;
    poses_.go_to_scan(scan.stamp_s);
    if (nodding.knots.size() < 2 || scan.ranges_m.empty()) return;
    const BeamTiming timing = calib::beam_timing(model_, scan);
    const auto step = static_cast<std::size_t>(
        std::max(1.0, std::floor(kBeamSpacing_rad / std::max(1e-6, std::fabs(scan.bearing_step_rad)))));
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); beam += step) {
      const auto range_m = static_cast<double>(scan.ranges_m[beam]);
      const bool is_return =
          std::isfinite(range_m) && range_m >= kLeastRange_m && range_m <= kMostRange_m && !scan.is_at_limit(range_m);
      if (!is_return || count_++ % every_ != 0) continue;
      add_beam(nodding, timing.of_beam_s(beam),
               scan.first_bearing_rad + static_cast<double>(beam) * scan.bearing_step_rad, range_m);
    }
    if (beams.size() > 2 * kMostBeams) thin();
  }
  void thin() {
    every_ *= 2;
    for (std::size_t k = 0; 2 * k < beams.size(); ++k) {
      beams[k] = beams[2 * k];
      strokes[k] = strokes[2 * k];
    }
    beams.resize((beams.size() + 1) / 2);
    strokes.resize(beams.size());
  }

  std::vector<SelfBeam> beams;
  std::vector<std::uint32_t> strokes;

 private:
  void add_beam(const NoddingScan& nodding, double offset_s, double bearing_rad, double range_m) {
    const std::optional<Pose2> T_map_base = poses_.at(nodding.record.scan.stamp_s + offset_s);
    const std::optional<double> turns = turns_at(nodding.knots, offset_s);
    if (!T_map_base || !turns) return;
    const double ticks = *turns * static_cast<double>(model_.encoder.ticks_per_turn);
    const std::optional<double> rate = calib::elevation_rate(model_, calib::crank_rad(model_.encoder, ticks));
    if (!rate) return;
    const bool lifts = *rate * model_.encoder.direction > 0.0;
    if (!beams.empty() && lifts != lifts_) ++stroke_;
    lifts_ = lifts;
    beams.push_back({ticks, bearing_rad, range_m, *T_map_base * nodding.record.scan.T_base_laser});
    strokes.push_back(stroke_);
  }

  const calib::SweepModel& model_;
  PosesOfLogs poses_;
  std::uint64_t count_ = 0;
  std::uint64_t every_ = 1;
  std::uint32_t stroke_ = 0;
  bool lifts_ = false;
};

// Equations (12) and (14) in double precision, with the elevation and pose of each beam.
std::vector<Point3> assembled(const std::vector<SelfBeam>& beams, const calib::SweepModel& model) {
  std::vector<Point3> points;
  points.reserve(beams.size());
  for (const SelfBeam& beam : beams) {
    const std::optional<double> elevation = calib::elevation_rad(model, calib::crank_rad(model.encoder, beam.ticks));
    const SinCos<double> bearing = sin_cos(beam.bearing_rad);
    const Point3 in_laser(beam.range_m * bearing.cos, beam.range_m * bearing.sin, 0.0);
    points.push_back(T_base_laser(model.mount, beam.T_map_level, elevation.value_or(0.0)) * in_laser);
  }
  return points;
}

}  // namespace

SelfCalibrateOutcome run_self_calibration(const SelfCalibrateJob& job, const std::function<void(double)>& progress,
                                          const std::function<bool()>& stop) {
  for (const std::string& log : job.logs) {
    if (log == "-") throw UsageError("--self reads the log twice, so it cannot come from the standard input");
  }
  SelfCalibrateOutcome outcome;
  const Trajectory trajectory = mapped_poses(job, outcome, progress, stop);
  outcome.start = job.start;
  BeamCollector collector(job.start, trajectory);
  ScanStream scans(job.logs, job.read, {});
  NoddingStream stream(scans, NodKind::kEncoder, job.start, {});
  while (const std::optional<NoddingScan> scan = stream.next()) {
    collector.add(*scan);
    ++outcome.scans;
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted while reading; nothing was written");
  }
  while (collector.beams.size() > kMostBeams) collector.thin();
  outcome.beams = collector.beams.size();
  outcome.strokes = collector.strokes.empty() ? 0 : collector.strokes.back() + 1;
  const auto assemble = [&](const calib::SweepModel& model) {
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted while calibrating; nothing was written");
    return assembled(collector.beams, model);
  };
  outcome.result = calib::self_calibrate(job.start, collector.strokes, assemble, job.options);
  outcome.distrust = calib::reason_for_distrust(outcome.result);
  return outcome;
}

}  // namespace gdtslam
