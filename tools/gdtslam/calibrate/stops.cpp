#include "calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kPlacesPerTurn = 1000.0;  // 0.36 deg: inside of it ranges bend by less than 0.1 mm
constexpr double kMostStopBeams = 41.0;
constexpr std::size_t kMostWaiting = 4096;
constexpr double kMemory_s = 1.0;           // kept crank messages before the oldest waiting scan
constexpr double kLeastSigma_m = 0.001;     // a perfectly repeatable laser still has an error
constexpr double kLeastMeanSigma_m = 1e-4;  // limited by the flatness of the wall
constexpr double kUnknownSigma_m = 0.01;    // if no place has enough ranges to estimate it
constexpr std::uint32_t kEnoughForScatter = 5;
constexpr double kLeastStopRange_m = 0.05;
constexpr double kMostTravel_m = 0.05;                         // limit for a standing robot
constexpr double kMostTurn_rad = 3.0 * kPi / 180.0;            // limit for a standing robot
constexpr double kMostBearingChange_rad = 1e-3 * kPi / 180.0;  // per beam from scan to scan; logs round their angles

// Index of the beam nearest to the forward direction; 0 if none points ahead.
std::size_t beam_ahead(const LaserScan& scan) {
  const double place = std::floor(-scan.first_bearing_rad / scan.bearing_step_rad + 0.5);
  return place >= 0.0 && place < static_cast<double>(scan.ranges_m.size()) ? static_cast<std::size_t>(place) : 0;
}

}  // namespace

std::optional<double> turns_at(const std::vector<PhaseKnot>& knots, double offset_s) {
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const PhaseKnot& from = knots[k];
    const PhaseKnot& to = knots[k + 1];
    if (offset_s > to.offset_s && k + 2 < knots.size()) continue;
    const double span_s = to.offset_s - from.offset_s;
    const double share = span_s > 0.0 ? std::clamp((offset_s - from.offset_s) / span_s, 0.0, 1.0) : 0.0;
    const double step = static_cast<double>(static_cast<std::int32_t>(to.phase - from.phase)) / 4294967296.0;
    return turns_of_phase(from.phase) + share * step;
  }
  return std::nullopt;
}

StopCollector::StopCollector(const calib::SweepModel& model, double sector_rad)
    : model_(model), half_sector_rad_(0.5 * sector_rad), track_(model.encoder, calib::NodTrackLimits{}) {}

void StopCollector::take(const LogRecord& record) {
  if (const auto* encoder = std::get_if<Encoder>(&record)) {
    ++encoder_messages_;
    track_.take(*encoder);
  } else if (std::holds_alternative<Tilt>(record)) {
    ++tilt_messages_;
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    note_odometry(odometry->T_odom_base);
  } else if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    ++statistics_.scans;
    if (scan->T_odom_base) note_odometry(*scan->T_odom_base);
    waiting_.push_back(scan->scan);
    order_beams_by_time(waiting_.back());
  }
  place_scans(false);
}

void StopCollector::note_odometry(const Pose2& T_odom_base) {
  if (!T_odom_first_) T_odom_first_ = T_odom_base;
  const Point2 moved = T_odom_base.translation() - T_odom_first_->translation();
  travel_.metres = std::max(travel_.metres, std::sqrt(moved.x() * moved.x() + moved.y() * moved.y()));
  travel_.angle_rad =
      std::max(travel_.angle_rad, std::fabs(wrap_angle(T_odom_base.theta_rad - T_odom_first_->theta_rad)));
}

std::vector<LogReader::Warning> StopCollector::finish_log(const std::string& name) {
  place_scans(true);
  require_counting(name);
  require_standing(name);
  std::vector<LogReader::Warning> warnings = track_.faults().as_warnings();
  if (uncovered_.count > 0) warnings.push_back(uncovered_);
  uncovered_.count = 0;
  const calib::NodTrack::Count& gaps = track_.faults().gaps;
  if (gaps_.count == 0) gaps_.first_stamp_s = gaps.first_stamp_s;
  gaps_.count += gaps.count;
  track_ = calib::NodTrack(model_.encoder, calib::NodTrackLimits{});
  T_odom_first_.reset();
  travel_ = {};
  return warnings;
}

// A log without a crank is reported by observations().
void StopCollector::require_standing(const std::string& name) const {
  if (encoder_messages_ == 0 || (travel_.metres <= kMostTravel_m && travel_.angle_rad <= kMostTurn_rad)) return;
  throw InputError(
      {name, 0}, fmt::format("the robot moved (its odometry: {:.2f} m and {:.1f} deg from where it was first), and it "
                             "must stand to be calibrated against surfaces; --self calibrates from a drive",
                             travel_.metres, deg_from_rad(travel_.angle_rad)));
}

void StopCollector::require_counting(const std::string& name) const {
  const calib::NodTrack::Count& jumps = track_.faults().jumps;
  if (jumps.count == 0 || model_.encoder.wraps) return;
  throw InputError(
      {name, 0},
      fmt::format(
          "the encoder jumps ({} times, first at {:.6f} s) and has no index mark (wraps: false), so nothing tells "
          "where the crank was afterwards; record anew, or cut the log there",
          jumps.count, jumps.first_stamp_s));
}

void StopCollector::place_scans(bool at_end) {
  const std::optional<double> known_s = track_.known_until_s();
  while (!waiting_.empty()) {
    const LaserScan& scan = waiting_.front();
    const BeamTiming timing = calib::beam_timing(model_, scan);
    const double last_s = scan.ranges_m.empty() ? 0.0 : timing.of_beam_s(scan.ranges_m.size() - 1);
    const bool is_covered = known_s && *known_s >= scan.stamp_s + std::max(0.0, last_s);
    if (!is_covered && !at_end && waiting_.size() <= kMostWaiting) return;
    add(scan);
    // A single stamp far ahead must not remove messages that other scans need.
    double oldest_s = std::min(scan.stamp_s + std::min(0.0, timing.first_s), known_s.value_or(scan.stamp_s));
    waiting_.pop_front();
    for (const LaserScan& other : waiting_) oldest_s = std::min(oldest_s, other.stamp_s);
    track_.forget_before(oldest_s - kMemory_s);
  }
}

// Step between beams that keeps at most kMostStopBeams of a sector.
std::size_t StopCollector::beam_step(const LaserScan& scan) const {
  const double beams = 2.0 * half_sector_rad_ / std::fabs(scan.bearing_step_rad) + 1.0;
  return static_cast<std::size_t>(std::max(1.0, std::ceil(beams / kMostStopBeams)));
}

// Ranges are averaged by beam number, so a number must mean the same bearing in all scans.
void StopCollector::note_beams(const LaserScan& scan) {
  if (bearing_step_rad_ == 0.0) {
    bearing_first_rad_ = scan.first_bearing_rad;
    bearing_step_rad_ = scan.bearing_step_rad;
    return;
  }
  const double last = static_cast<double>(scan.ranges_m.size() - 1);
  const double at_first_rad = std::fabs(wrap_angle(scan.first_bearing_rad - bearing_first_rad_));
  const double at_last_rad = std::fabs(last * (scan.bearing_step_rad - bearing_step_rad_));
  if (at_first_rad <= kMostBearingChange_rad && at_last_rad <= kMostBearingChange_rad) return;
  throw InputError(
      fmt::format("the scan at {:.6f} s has its first beam at {:.3f} deg and one each {:.4f} deg, earlier scans at "
                  "{:.3f} deg and each "
                  "{:.4f} deg; calibrate takes the scans of one laser with one setting",
                  scan.stamp_s, deg_from_rad(scan.first_bearing_rad), deg_from_rad(scan.bearing_step_rad),
                  deg_from_rad(bearing_first_rad_), deg_from_rad(bearing_step_rad_)));
}

void StopCollector::add(const LaserScan& scan) {
  if (scan.ranges_m.empty() || !(std::fabs(scan.bearing_step_rad) > 0.0)) return;
  note_beams(scan);
  const BeamTiming timing = calib::beam_timing(model_, scan);
  const double last_s = timing.of_beam_s(scan.ranges_m.size() - 1);
  const std::vector<PhaseKnot> knots = track_.knots(scan.stamp_s, scan.stamp_s + timing.first_s, scan.stamp_s + last_s);
  if (knots.empty()) {
    ++statistics_.uncovered;
    if (uncovered_.count++ == 0) uncovered_.first = fmt::format("scan at {:.6f} s", scan.stamp_s);
    return;
  }
  const double half_step_rad = 0.5000001 * std::fabs(scan.bearing_step_rad);
  const std::size_t step = beam_step(scan);
  const std::size_t ahead = beam_ahead(scan);
  for (std::size_t beam = ahead % step; beam < scan.ranges_m.size(); beam += step) {
    const double bearing_rad = wrap_angle(scan.first_bearing_rad + static_cast<double>(beam) * scan.bearing_step_rad);
    if (std::fabs(bearing_rad) > std::max(half_sector_rad_, half_step_rad)) continue;
    const std::optional<double> turns = turns_at(knots, timing.of_beam_s(beam));
    if (!turns) continue;
    const double share = *turns - std::floor(*turns);
    const auto place = static_cast<std::uint32_t>(std::floor(share * kPlacesPerTurn + 0.5)) %
                       static_cast<std::uint32_t>(kPlacesPerTurn);
    const double range_m = static_cast<double>(scan.ranges_m[beam]);
    const bool is_return = std::isfinite(range_m) && range_m > kLeastStopRange_m && !scan.is_at_limit(range_m);
    // A position across tick 0 counts from negative ticks.
    const double ticks =
        (place == 0 && share > 0.5 ? share - 1.0 : share) * static_cast<double>(model_.encoder.ticks_per_turn);
    add_range({place, static_cast<std::uint32_t>(beam)}, ticks, range_m, is_return);
  }
}

void StopCollector::add_range(std::pair<std::uint32_t, std::uint32_t> key, double ticks, double range_m,
                              bool is_return) {
  Sums& sums = sums_[key];
  ++sums.scans;
  if (!is_return) return;
  ++statistics_.ranges;
  if (sums.count == 0) {
    sums.first_ticks = ticks;
    sums.first_range_m = range_m;
  }
  const double t = ticks - sums.first_ticks;
  const double r = range_m - sums.first_range_m;
  ++sums.count;
  sums.ticks += t;
  sums.range_m += r;
  sums.sq_ticks += t * t;
  sums.sq_range += r * r;
  sums.product += t * r;
}

// Median scatter of the ranges about a line over the ticks, because a turning crank changes the range.
double StopCollector::scatter_m() const {
  std::vector<double> variances;
  for (const auto& [key, sums] : sums_) {
    if (sums.count < kEnoughForScatter) continue;
    const double n = sums.count;
    const double tt = sums.sq_ticks - sums.ticks * sums.ticks / n;
    const double rr = sums.sq_range - sums.range_m * sums.range_m / n;
    const double tr = sums.product - sums.ticks * sums.range_m / n;
    const double explained = tt > 1e-9 ? tr * tr / tt : 0.0;
    variances.push_back(std::max(0.0, rr - explained) / (n - (tt > 1e-9 ? 2.0 : 1.0)));
  }
  if (variances.empty()) return kUnknownSigma_m;
  return std::max(kLeastSigma_m, std::sqrt(upper_median(variances)));
}

std::vector<calib::RangeObservation> StopCollector::observations(double sigma_m) {
  if (encoder_messages_ == 0) {
    throw InputError(tilt_messages_ > 0
                         ? "the log measures the elevation itself (TILT), so there is no linkage to calibrate"
                         : "the log has no ENCODER message, so nothing tells where the crank was (docs/formats.md)");
  }
  if (statistics_.scans == 0) throw InputError("the log has no scan");
  if (statistics_.scans == statistics_.uncovered && gaps_.count > 0) {
    throw InputError(fmt::format(
        "at the time of none of the {} scans the crank's place is known: messages of the encoder are more than "
        "{:g} s apart ({} times, first at {:.6f} s); record it more often, also while the crank stands",
        statistics_.scans, calib::NodTrackLimits{}.max_gap_s, gaps_.count, gaps_.first_stamp_s));
  }
  if (statistics_.scans == statistics_.uncovered) {
    throw InputError(
        fmt::format("at the time of none of the {} scans the crank's place is known; do the stamps of the "
                    "ENCODER messages and of the scans belong together?",
                    statistics_.scans));
  }
  statistics_.range_sigma_m = sigma_m > 0.0 ? sigma_m : scatter_m();
  std::vector<calib::RangeObservation> list;
  std::uint32_t last_place = 0;
  for (const auto& [key, sums] : sums_) {
    if (2 * sums.count < sums.scans || sums.count == 0)
      continue;  // mostly no return: the few returns come from something else
    if (list.empty() || key.first != last_place) ++statistics_.stops;
    last_place = key.first;
    const double n = sums.count;
    list.push_back({.ticks = sums.first_ticks + sums.ticks / n,
                    .bearing_rad = wrap_angle(bearing_first_rad_ + key.second * bearing_step_rad_),
                    .range_m = sums.first_range_m + sums.range_m / n,
                    .sigma_m = std::max(kLeastMeanSigma_m, statistics_.range_sigma_m / std::sqrt(n)),
                    .count = sums.count});
  }
  return list;
}

}  // namespace gdtslam
