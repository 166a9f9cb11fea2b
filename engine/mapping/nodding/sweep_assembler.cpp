#include "sweep_assembler.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/angle.hpp"
#include "sweep_batch.hpp"

namespace gdtslam {
namespace {

/// The nearest whole metre.
double anchor_near(double coordinate_m) { return std::floor(coordinate_m + 0.5); }

/// True if points can be computed from the scan: the elevation is known, and the sensor has a valid position.
bool has_points(const NoddingScan& scan) {
  const Pose2& level = scan.record.scan.T_base_laser;
  return !scan.knots.empty() && level.is_finite() && std::fabs(level.x_m) < kFurthestFromRobot_m &&
         std::fabs(level.y_m) < kFurthestFromRobot_m;
}

BeamStrip kernel_strip(const ScanStrip& strip, const Pose2& T_map_fix, const StripOrigin& origin) {
  BeamStrip values;
  values.phase = strip.phase;
  values.phase_step = strip.phase_step;
  values.x_m = static_cast<float>(strip.T_fix_level.x_m);
  values.y_m = static_cast<float>(strip.T_fix_level.y_m);
  values.yaw_rad = static_cast<float>(strip.T_fix_level.theta_rad);
  values.x_step_m = static_cast<float>(strip.step.x_m);
  values.y_step_m = static_cast<float>(strip.step.y_m);
  values.yaw_step_rad = static_cast<float>(strip.step.theta_rad);
  values.outer_x_m = static_cast<float>(T_map_fix.x_m - origin.anchor_x_m);
  values.outer_y_m = static_cast<float>(T_map_fix.y_m - origin.anchor_y_m);
  const SinCos<double> outer = sin_cos(T_map_fix.theta_rad);
  values.outer_cos = static_cast<float>(outer.cos);
  values.outer_sin = static_cast<float>(outer.sin);
  return values;
}

}  // namespace

BeamTiming NoddingScanner::timing(std::size_t beams, double bearing_step_rad) const {
  if (!(mirror_rate_hz > 0.0) || beams == 0) return {};
  BeamTiming timing;
  timing.step_s = std::fabs(bearing_step_rad) / kTwoPi / mirror_rate_hz;
  timing.first_s = -stamp_share * static_cast<double>(beams - 1) * timing.step_s;
  return timing;
}

BeamTiming NoddingScanner::timing(const LaserScan& scan) const {
  return stated_timing(scan).value_or(timing(scan.ranges_m.size(), scan.bearing_step_rad));
}

/// Batches wait in the order of their scans: the first one or two are on the device, the last one is being filled.
struct SweepAssembler::State {
  struct Waiting {
    SweepBatch batch;
    std::optional<PendingDownload> download;  ///< when the device has it
  };

  State(const NoddingScanner& of_scans, const AssemblyLimits& given, Backend& on, CloudSink& next)
      : scanner(of_scans), limits(given), backend(&on), sink(next) {
    limits.batch_beams = std::max(limits.batch_beams, kMostBeamsOfStrip);
  }

  /// Row of a scan's first beam, in a table that `directions` then holds.
  std::uint32_t find_row(const LaserScan& scan) {
    if (directions) {
      if (const auto row = directions->find_row(scan)) return *row;
    }
    close_batch();  // its strips refer to rows of the old table
    directions = std::make_shared<BeamDirections>(scanner.mount);
    return *directions->find_row(scan);
  }

  void close_batch() {
    if (!filling.beams.empty()) waiting.push_back({std::exchange(filling, {}), std::nullopt});
  }

  /// Reads the ranges of a strip, 0 without a valid return; returns true if there is any.
  bool take_ranges(const LaserScan& scan, const ScanStrip& strip) {
    const double limit = range_limit_m(scan, limits.max_range_m);
    ranges.clear();
    bool any = false;
    for (std::size_t beam = strip.first; beam < strip.first + strip.count; ++beam) {
      const auto range = static_cast<double>(scan.ranges_m[beam]);
      const bool valid = range > 0.0 && range >= limits.min_range_m && range < limit;  // false for NaN too
      ranges.push_back(valid ? scan.ranges_m[beam] : 0.0F);
      any |= valid;
    }
    return any;
  }

  void queue(BeamStrip strip, const StripOrigin& origin) {
    if (filling.beams.size() + ranges.size() > limits.batch_beams) close_batch();
    filling.directions = directions;
    strip.first_beam = static_cast<std::uint32_t>(filling.beams.size());
    const auto number = static_cast<std::uint32_t>(filling.strips.size());
    filling.strips.push_back(strip);
    filling.origins.push_back(origin);
    for (const float range_m : ranges) filling.beams.push_back({range_m, number});
  }

  void start(Waiting& next) {
    if (next.download) return;
    if (!device) device = std::make_unique<SweepDevice>(*backend, scanner, limits, limits.batch_beams);
    next.download = device->start(next.batch);
  }

  /// Delivers the first batch. It stays in the queue until the device has delivered it.
  void deliver() {
    const std::vector<SweptBeam> swept = device->finish(std::move(*waiting.front().download));
    points.clear();
    append_points(waiting.front().batch, swept, points);
    waiting.pop_front();
    delivered += points.size();
    sink.add(points);
  }

  /// Works until at most this many batches wait. The device gets a batch before the previous one is fetched.
  void work(std::size_t may_wait) {
    while (waiting.size() > may_wait) {
      start(waiting[0]);
      if (waiting.size() > 1) start(waiting[1]);
      deliver();
    }
    if (!waiting.empty()) start(waiting[0]);
  }

  NoddingScanner scanner;
  AssemblyLimits limits;
  Backend* backend;
  CloudSink& sink;
  std::shared_ptr<BeamDirections> directions;
  std::unique_ptr<SweepDevice> device;
  std::deque<Waiting> waiting;
  SweepBatch filling;
  std::vector<float> ranges;       // ranges of the current strip
  std::vector<CloudPoint> points;  // points of the current batch
  std::uint64_t delivered = 0;
};

SweepAssembler::SweepAssembler(const NoddingScanner& scanner, const AssemblyLimits& limits, Backend& backend,
                               CloudSink& sink)
    : state_(std::make_unique<State>(scanner, limits, backend, sink)) {}

SweepAssembler::~SweepAssembler() = default;

void SweepAssembler::add(const NoddingScan& scan, std::uint32_t index, const Pose2& T_map_fix,
                         std::span<const PoseKnot> poses) {
  assert(!poses.empty() && T_map_fix.is_finite());
  const LaserScan& laser = scan.record.scan;
  if (laser.ranges_m.empty() || !has_points(scan)) return;
  const BeamTiming timing = state_->scanner.timing(laser);
  const std::uint32_t row = state_->find_row(laser);
  StripOrigin origin{laser.stamp_s, timing, anchor_near(T_map_fix.x_m), anchor_near(T_map_fix.y_m), 0, index};
  for (const ScanStrip& strip : make_strips({scan.knots, poses, timing, laser.ranges_m.size(), laser.T_base_laser})) {
    if (!state_->take_ranges(laser, strip)) continue;
    origin.first_beam = strip.first;
    BeamStrip values = kernel_strip(strip, T_map_fix, origin);
    values.first_direction = row + static_cast<std::uint32_t>(strip.first);
    state_->queue(values, origin);
  }
  state_->work(1);
}

void SweepAssembler::flush() {
  state_->close_batch();
  state_->work(0);
}

void SweepAssembler::use_backend(Backend& backend) {
  for (State::Waiting& batch : state_->waiting) batch.download.reset();
  state_->device.reset();
  state_->backend = &backend;
  state_->work(1);
}

std::uint64_t SweepAssembler::points() const { return state_->delivered; }

}  // namespace gdtslam
