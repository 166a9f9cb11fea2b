// The log as a whole, and the messages of a nodding mount in it.
#include "log_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

template <class Value>
void widen(Value& lowest, Value& highest, Value value, bool is_first) {
  lowest = is_first ? value : std::min(lowest, value);
  highest = is_first ? value : std::max(highest, value);
}

}  // namespace

void NodChecker::add_time(double stamp_s) {
  if (!first_s_) {
    first_s_ = last_s_ = stamp_s;
    return;
  }
  const double step_s = stamp_s - last_s_;
  if (step_s < 0.0) {
    ++check_.backward_stamps;
    return;
  }
  if (step_s > check_.longest_gap_s) {
    check_.longest_gap_s = step_s;
    check_.longest_gap_at_s = last_s_;
  }
  last_s_ = stamp_s;
}

void NodChecker::add(const Encoder& message) {
  add_time(message.stamp_s);
  widen(check_.lowest_ticks, check_.highest_ticks, message.ticks, check_.encoder_records++ == 0);
}

void NodChecker::add(const Tilt& message) {
  add_time(message.stamp_s);
  widen(check_.lowest_tilt_rad, check_.highest_tilt_rad, message.elevation_rad, check_.tilt_records++ == 0);
}

NodCheck NodChecker::finish() const {
  NodCheck check = check_;
  const double span_s = first_s_ ? last_s_ - *first_s_ : 0.0;
  const auto records = static_cast<double>(std::max(check.encoder_records, check.tilt_records));
  check.mean_rate_hz = span_s > 0.0 ? (records - 1.0) / span_s : 0.0;
  return check;
}

std::vector<std::string> NodCheck::suggestions() const {
  std::vector<std::string> list;
  if (!has_records()) return list;
  list.emplace_back(encoder_records > 0
                        ? "the laser nods: 'map --linkage' makes a 3D cloud, 'linkage --list' names linkages"
                        : "the laser tilts: 'map' makes a 3D cloud");
  if (longest_gap_s > calib::NodTrackLimits{}.max_gap_s) {
    list.emplace_back(
        fmt::format("no message of the mount for {:.3f} s after {:.6f} s: scans there get no points "
                    "(nod.max_gap)",
                    longest_gap_s, longest_gap_at_s));
  }
  if (backward_stamps > 0) {
    list.emplace_back("stamps of the mount's messages go backward: those messages are dropped");
  }
  if (encoder_records > 1 && highest_ticks == lowest_ticks) {
    list.emplace_back("the crank never turns, or its encoder is dead");
  }
  return list;
}

namespace {

constexpr std::size_t kStepBins = 10001;  // milliseconds
constexpr std::size_t kMostLayouts = 16;  // layouts of a laser
constexpr std::size_t kMostMounts = 64;   // further lasers count as the last one
constexpr double kShortestGap_s = 1.0;
constexpr double kGapSteps = 5.0;      // a gap is this many usual steps, and at least kShortestGap_s
constexpr double kLongSteps_s = 20.0;  // steps between scans that suggest another unit than seconds
constexpr double kMostStep_s = 1e30;
constexpr double kMountShift_m = 1e-3;
constexpr double kMountTurn_rad = 0.1 * kPi / 180.0;

void add_laser_suggestions(const LogCheck& check, std::vector<std::string>& list) {
  const bool is_alone = check.lasers.size() == 1;
  for (const LaserMount& mount : check.lasers) {
    const auto is_its_own = [&mount](const BeamLayout& layout) { return layout.laser == mount.laser; };
    if (std::count_if(check.layouts.begin(), check.layouts.end(), is_its_own) < 2) continue;
    list.push_back(is_alone ? "the beams change within the log: no matter where a laser turns unevenly, else check "
                              "that it holds one sensor only"
                            : fmt::format("the beams of laser {} change within the log: no matter where it turns "
                                          "unevenly, else check that it is one sensor only",
                                          mount.laser));
  }
  for (const LaserMount& mount : check.lasers) {
    if (mount.changes == 0) continue;
    list.push_back((is_alone ? "the laser" : fmt::format("laser {}", mount.laser)) +
                   " moves on the robot: the laser poses of the log may be corrected ones, not odometry");
  }
}

}  // namespace

bool is_mappable(const LaserScan& scan, const ScanConfig& config) {
  return to_points(scan, config).size() >= static_cast<std::size_t>(config.min_points);
}

std::string nothing_mappable(std::uint64_t scans, const ScanConfig& config) {
  return fmt::format(
      "none of the {} scans has {} returns (scan.min_points) between {:g} m (scan.min_range) and {:g} m "
      "(scan.max_range)",
      scans, config.min_points, config.min_range_m, config.max_range_m);
}

std::string question_of_unit(double usual_step_s) {
  if (!(usual_step_s >= kLongSteps_s)) return "";
  const char* const unit = usual_step_s < 1e4 ? "milliseconds" : usual_step_s < 1e7 ? "microseconds" : "nanoseconds";
  return fmt::format(
      "stamps are taken as seconds, and there are {:g} s from scan to scan: are they {}? Then convert them to seconds",
      usual_step_s, unit);
}

std::string question_of_unit(const Trajectory& trajectory) {
  std::vector<double> steps_s{0.0};
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const double step_s = trajectory[i].stamp_s - trajectory[i - 1].stamp_s;
    if (step_s > 0.0) steps_s.push_back(step_s);
  }
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  return question_of_unit(*middle);
}

bool is_impossible(const Pose2& step, double step_s, const StepBounds& bounds) {
  const double allowed_s = step_s > 0.0 ? std::min(step_s, bounds.longest_s) : bounds.unknown_s;
  return step.translation().norm() > bounds.distance_m + bounds.speed_m_s * allowed_s ||
         std::fabs(step.theta_rad) > bounds.angle_rad + bounds.turn_rate_rad_s * allowed_s;
}

void EventList::add(const LogEvent& event, double size) {
  ++count;
  largest = std::max(largest, size);
  if (first.size() < kMostListed) first.push_back(event);
}

void LogChecker::add(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) add_scan(*scan);
  if (const auto* odometry = std::get_if<Odometry>(&record)) {
    ++check_.odometry_records;
    if (check_.scans_with_odometry == 0) add_odometry(odometry->stamp_s, odometry->T_odom_base, last_record_);
  }
  if (const auto* encoder = std::get_if<Encoder>(&record)) nod_.add(*encoder);
  if (const auto* tilt = std::get_if<Tilt>(&record)) nod_.add(*tilt);
}

void LogChecker::add_scan(const ScanRecord& record) {
  const std::size_t place = find_laser(record);
  LastScan& last = last_scans_[place];
  add_time(record.scan.stamp_s, last.stamp_s);
  if (record.T_odom_base) {
    if (check_.scans_with_odometry++ == 0) last_odometry_.reset();  // from now on only the scans' own odometry counts
    add_odometry(record.scan.stamp_s, *record.T_odom_base, last.T_odom_base);
  }
  add_ranges(record);
  check_.mappable_scans += is_mappable(record.scan, check_.scan) ? 1U : 0U;
  add_mount(record.scan.T_base_laser, check_.lasers[place]);
  add_layout(record.scan, check_.lasers[place].laser);
  ++check_.scans;
}

// Index in the lists with one entry for each laser.
std::size_t LogChecker::find_laser(const ScanRecord& record) {
  std::vector<LaserMount>& lasers = check_.lasers;
  const auto same = std::find_if(lasers.begin(), lasers.end(),
                                 [&record](const LaserMount& mount) { return mount.laser == record.laser; });
  if (same != lasers.end()) return static_cast<std::size_t>(same - lasers.begin());
  if (lasers.size() < kMostMounts) {
    lasers.push_back({.laser = record.laser, .T_base_laser = record.scan.T_base_laser});
    last_scans_.emplace_back();
  }
  return lasers.size() - 1;
}

void LogChecker::add_time(double stamp_s, std::optional<double>& before_s) {
  check_.first_stamp_s = last_scan_s_ ? std::min(check_.first_stamp_s, stamp_s) : stamp_s;
  check_.last_stamp_s = last_scan_s_ ? std::max(check_.last_stamp_s, stamp_s) : stamp_s;
  const LogEvent event{.scan = check_.scans, .stamp_s = stamp_s};
  if (last_scan_s_) add_pause(event, stamp_s - *last_scan_s_);
  // Scans of several lasers at one moment come in any order: only a large step back between lasers counts.
  const bool is_far_back = last_scan_s_ && stamp_s - *last_scan_s_ <= -kShortestGap_s;
  const std::optional<double>& since_s = is_far_back ? last_scan_s_ : before_s;
  if (since_s) add_step(event, stamp_s - *since_s);
  last_scan_s_ = stamp_s;
  before_s = stamp_s;
}

void LogChecker::add_step(LogEvent event, double step_s) {
  event.time_step_s = step_s;
  if (step_s < 0.0) {
    check_.backward_stamps.add(event, -step_s);
  } else if (step_s == 0.0) {
    check_.repeated_stamps.add(event, 0.0);
  } else {
    steps_ms_.resize(kStepBins);
    const std::size_t bin = find_bin(step_s * 1e3, kStepBins);
    ++steps_ms_[bin];
    if (bin + 1 == kStepBins) long_steps_s_ += std::min(step_s, kMostStep_s);
  }
}

void LogChecker::add_pause(LogEvent event, double pause_s) {
  if (!(pause_s > 0.0)) return;
  event.time_step_s = pause_s;
  pauses_ms_.resize(kStepBins);
  ++pauses_ms_[find_bin(pause_s * 1e3, kStepBins)];
  const auto place = std::find_if(longest_pauses_.begin(), longest_pauses_.end(),
                                  [pause_s](const LogEvent& e) { return e.time_step_s < pause_s; });
  longest_pauses_.insert(place, event);
  if (longest_pauses_.size() > EventList::kMostListed) longest_pauses_.pop_back();
}

void LogChecker::add_odometry(double stamp_s, const Pose2& T_odom_base, std::optional<Pose2>& before) {
  if (!T_odom_base.is_finite()) return;  // the reader counts it
  units_.add_heading(stamp_s, T_odom_base.theta_rad);
  if (before && T_odom_base == *before) ++check_.still_scans;
  before = T_odom_base;
  if (last_odometry_) {
    const Pose2 step = between(last_odometry_->T_map_base, T_odom_base);
    const double distance_m = step.translation().norm();
    const double angle_rad = std::fabs(step.theta_rad);
    const double step_s = stamp_s - last_odometry_->stamp_s;
    if (is_impossible(step, step_s, bounds_)) {
      check_.impossible_steps.add({check_.scans, stamp_s, step_s, distance_m, angle_rad}, distance_m);
    } else {
      check_.path_m += distance_m;
      check_.turned_rad += angle_rad;
    }
  }
  last_odometry_ = {stamp_s, T_odom_base};
}

void LogChecker::add_ranges(const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  no_return_.add(scan, record.laser);
  check_.ranges.beams += scan.ranges_m.size();
  units_.add_ranges(scan);
  bool has_return = false;
  for (const float range : scan.ranges_m) {
    const auto range_m = static_cast<double>(range);
    if (!std::isfinite(range_m)) ++check_.ranges.not_finite;
    has_return = has_return || (std::isfinite(range_m) && range_m > 0.0 && !scan.is_at_limit(range_m));
  }
  if (!has_return) ++check_.scans_without_returns;
}

void LogChecker::add_layout(const LaserScan& scan, std::size_t laser) {
  std::size_t listed = 0;
  for (BeamLayout& layout : check_.layouts) {
    if (layout.laser != laser) continue;
    ++listed;
    if (layout.beams == scan.ranges_m.size() && layout.first_bearing_rad == scan.first_bearing_rad &&
        layout.step_rad == scan.bearing_step_rad && layout.max_range_m == scan.max_range_m) {
      ++layout.scans;
      return;
    }
  }
  if (listed == kMostLayouts) {
    ++check_.other_layouts;
    return;
  }
  check_.layouts.push_back(
      {scan.ranges_m.size(), scan.first_bearing_rad, scan.bearing_step_rad, scan.max_range_m, 1, laser});
}

void LogChecker::add_mount(const Pose2& T_base_laser, LaserMount& mount) {
  if (mount.scans++ == 0) return;
  const Pose2 change = between(mount.T_base_laser, T_base_laser);
  if (change.translation().norm() > kMountShift_m || std::fabs(change.theta_rad) > kMountTurn_rad) ++mount.changes;
}

void LogChecker::finish_times(LogCheck& check) const {
  if (pauses_ms_.empty()) return;
  check.median_step_s = static_cast<double>(quantile_bin(steps_ms_, 0.5)) * 1e-3;
  const bool is_long = quantile_bin(steps_ms_, 0.5) + 1 == kStepBins;
  check.usual_step_s = is_long ? long_steps_s_ / static_cast<double>(steps_ms_.back()) : check.median_step_s;
  const double longest_s = static_cast<double>(kStepBins - 1) * 1e-3;
  check.gap_bound_s = std::min(std::max(kShortestGap_s, kGapSteps * check.median_step_s), longest_s);
  for (std::size_t bin = find_bin(check.gap_bound_s * 1e3, kStepBins); bin < pauses_ms_.size(); ++bin) {
    check.gaps.count += pauses_ms_[bin];
  }
  for (const LogEvent& event : longest_pauses_) {
    if (check.gaps.first.size() < check.gaps.count) check.gaps.first.push_back(event);
  }
  if (check.gaps.count > 0) check.gaps.largest = longest_pauses_.front().time_step_s;
}

void LogChecker::finish_ranges(LogCheck& check) const {
  if (no_return_.below_cm().empty()) return;
  RangeStatistics& ranges = check.ranges;
  std::vector<std::uint64_t> returns = no_return_.below_cm();
  const std::vector<std::uint64_t>& at_limit = no_return_.at_limit_cm();
  check.no_returns = no_return_.finish();
  ranges.no_return_m = check.no_returns.at_limit_m;
  ranges.no_return_count = std::accumulate(at_limit.begin(), at_limit.end(), std::uint64_t{0});
  for (const NoReturnValue& value : check.no_returns.below) {
    const std::size_t bin = find_bin(static_cast<double>(static_cast<float>(value.range_m)) * 100.0, returns.size());
    if (bin + 1 == returns.size() && units_.are_ranges_doubtful()) continue;  // ranges in another unit, not a constant
    ranges.no_return_m.push_back(static_cast<double>(bin) / 100.0);
    ranges.no_return_count += returns[bin];
    returns[bin] = 0;
  }
  ranges.not_finite += std::exchange(returns.front(), 0);  // a range of zero is none
  ranges.returns = std::accumulate(returns.begin(), returns.end(), std::uint64_t{0});
  if (ranges.returns == 0) return;
  ranges.shortest_m = static_cast<double>(quantile_bin(returns, 0.0)) / 100.0;
  ranges.median_m = static_cast<double>(quantile_bin(returns, 0.5)) / 100.0;
  std::size_t last = returns.size();
  while (returns[last - 1] == 0) --last;
  ranges.longest_m = static_cast<double>(last - 1) / 100.0;
}

LogCheck LogChecker::finish(const std::vector<LogReader::Warning>& warnings) const {
  LogCheck check = check_;
  check.warnings = warnings;
  check.questions_of_units = units_.questions();
  check.nod = nod_.finish();
  finish_times(check);
  finish_ranges(check);
  return check;
}

std::string LogCheck::obstacle() const {
  if (scans == 0) return "it holds no laser scan";
  if (mappable_scans > 0) return "";  // also if all ranges are equal, which in another log would mean no return
  if (ranges.returns == 0) return "no beam of any scan has a return";
  return nothing_mappable(scans, scan);
}

std::vector<std::string> LogCheck::suggestions() const {
  std::vector<std::string> list;
  const auto warned = [this](std::string_view kind) {
    return std::any_of(warnings.begin(), warnings.end(), [kind](const auto& w) { return w.kind == kind; });
  };
  if (warned("malformed line")) list.emplace_back("map it with --lenient, which skips the malformed lines");
  if (scans_with_odometry == 0 && odometry_records == 0 && scans > 0) {
    list.emplace_back(
        "there is no odometry: scans are matched to the map alone; slow motion and rich surroundings help");
  }
  if (impossible_steps.count > 0) {
    list.emplace_back(
        "the odometry jumps: the search window grows with the step (search.half_width_per_metre, "
        "search.half_angle_per_radian); look at the doubtful scans of the report");
  }
  if (std::string question = question_of_unit(usual_step_s); !question.empty()) list.push_back(std::move(question));
  list.insert(list.end(), questions_of_units.begin(), questions_of_units.end());
  if (backward_stamps.count > 0) list.emplace_back("stamps go backward: the order of the file is kept, do not sort it");
  if (gaps.count > 0) list.emplace_back("the robot may have moved in the gaps; odometry must carry over them");
  add_laser_suggestions(*this, list);
  for (std::string& text : nod.suggestions()) list.push_back(std::move(text));
  return list;
}

}  // namespace gdtslam
