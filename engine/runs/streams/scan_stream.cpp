#include "scan_stream.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

constexpr double kShareOfNewGap = 0.2;  // weight of a new gap in the running mean
constexpr double kClearPause = 2.0;     // least ratio of the two longest gaps, so that jitter does not decide

}  // namespace

bool ObservationCollector::is_active(const Laser& laser) const {
  return count_ - laser.last_observation <= kActiveObservations;
}

bool ObservationCollector::has_scan_from(std::size_t laser) const {
  return std::any_of(scans_.begin(), scans_.end(), [laser](const ScanRecord& scan) { return scan.laser == laser; });
}

// Also false if a stamp is not a number.
bool ObservationCollector::has_room_for(const ScanRecord& scan) const {
  return scans_.size() < kMostLasers && std::fabs(scan.scan.stamp_s - scans_.front().scan.stamp_s) < kLongest_s;
}

bool ObservationCollector::is_complete() const {
  return std::all_of(lasers_.begin(), lasers_.end(),
                     [this](const auto& laser) { return !is_active(laser.second) || has_scan_from(laser.first); });
}

ObservationCollector::Laser& ObservationCollector::find_laser(std::size_t number) {
  const auto known =
      std::find_if(lasers_.begin(), lasers_.end(), [number](const auto& laser) { return laser.first == number; });
  if (known != lasers_.end()) return known->second;
  if (lasers_.size() >= kMostLasers) lasers_.erase(lasers_.begin());
  return lasers_.emplace_back(number, Laser{}).second;
}

void ObservationCollector::take(ScanRecord scan) {
  const double stamp_s = scan.scan.stamp_s;
  if (!scans_.empty() && (!has_room_for(scan) || has_scan_from(scan.laser) || first_ == scan.laser)) finish();
  Laser& laser = find_laser(scan.laser);
  laser.last_observation = count_;
  const double gap_s = last_stamp_s_ ? std::fabs(stamp_s - *last_stamp_s_) : kLongest_s;
  if (gap_s < kLongest_s) laser.gap_s = laser.gap_s ? *laser.gap_s + kShareOfNewGap * (gap_s - *laser.gap_s) : gap_s;
  last_stamp_s_ = stamp_s;
  scans_.push_back(std::move(scan));
  if (is_complete()) finish();
}

void ObservationCollector::finish() {
  ready_.push_back(std::exchange(scans_, {}));
  ++count_;
  choose_first();
}

void ObservationCollector::choose_first() {
  first_.reset();
  double longest_s = 0.0;
  double second_s = 0.0;
  std::size_t active = 0;
  for (const auto& [number, laser] : lasers_) {
    if (!is_active(laser) || !laser.gap_s) continue;
    ++active;
    if (*laser.gap_s > longest_s) {
      second_s = std::exchange(longest_s, *laser.gap_s);
      first_ = number;
    } else {
      second_s = std::max(second_s, *laser.gap_s);
    }
  }
  if (active < 2 || longest_s <= kClearPause * second_s) first_.reset();
}

void ObservationCollector::end_log() {
  if (!scans_.empty()) finish();
  lasers_.clear();
  first_.reset();
  last_stamp_s_.reset();
}

std::optional<Observation> ObservationCollector::next(bool at_end) {
  if (ready_.empty() && at_end && !scans_.empty()) finish();
  if (ready_.empty()) return std::nullopt;
  Observation observation = std::move(ready_.front());
  ready_.pop_front();
  return observation;
}

Pose2 interpolated(const Odometry& a, const Odometry& b, double stamp_s) {
  const double span_s = b.stamp_s - a.stamp_s;
  if (!(span_s > 0.0)) return a.T_odom_base;
  const double share = std::clamp((stamp_s - a.stamp_s) / span_s, 0.0, 1.0);
  return a.T_odom_base * exp_se2(share * log_se2(between(a.T_odom_base, b.T_odom_base)));
}

void state_beam_times(const ReadOptions& options, LaserScan& scan) {
  if (options.first_beam_after_s) scan.first_beam_after_s = *options.first_beam_after_s;
  if (options.beam_period_s) scan.beam_period_s = *options.beam_period_s;
  if (!options.deskew) scan.first_beam_after_s = scan.beam_period_s = 0.0;
}

std::string log_name(const std::string& path) { return path == "-" ? "standard input" : path; }

void OdometryInterpolator::take(const Odometry& odometry) {
  for (ScanRecord& scan : waiting_) {
    scan.T_odom_base = interpolated(*last_, odometry, scan.scan.stamp_s);
    ready_.push_back(std::move(scan));
  }
  waiting_.clear();
  last_ = odometry;
}

void OdometryInterpolator::take(ScanRecord scan) {
  const bool complete = scan.T_odom_base.has_value() || !last_.has_value();
  if (!complete && waiting_.size() < kMostHeld) {
    waiting_.push_back(std::move(scan));
    return;
  }
  for (ScanRecord& held : waiting_) {  // waiting scans go first, at the last known pose, to keep the order
    held.T_odom_base = last_->T_odom_base;
    ready_.push_back(std::move(held));
  }
  waiting_.clear();
  if (!complete) scan.T_odom_base = last_->T_odom_base;
  ready_.push_back(std::move(scan));
}

std::optional<ScanRecord> OdometryInterpolator::next(bool at_end) {
  if (ready_.empty() && at_end && !waiting_.empty()) {
    waiting_.front().T_odom_base = last_->T_odom_base;
    ready_.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
  }
  if (ready_.empty()) return std::nullopt;
  ScanRecord scan = std::move(ready_.front());
  ready_.pop_front();
  return scan;
}

ScanStream::ScanStream(std::vector<std::string> paths, const ReadOptions& options, const ScanRange& range, OpenLog open)
    : paths_(std::move(paths)), options_(options), range_(range), open_(std::move(open)) {
  open_next();
}

// The previous reader stays until the next log is open, because opening a pipe can block. Until then, progress() and
// warnings() report the previous log.
void ScanStream::open_next() {
  std::unique_ptr<LogReader> next;
  if (opened_ < paths_.size()) {
    try {
      if (opened_ > 0 && listener_.next_log) listener_.next_log();
      next = open_ ? open_(opened_) : open_log(paths_[opened_], options_);
    } catch (...) {
      open_problem_ = std::current_exception();
      throw;
    }
    ++opened_;
  }
  if (reader_) merge_warnings(earlier_warnings_, reader_->warnings());
  reader_ = std::move(next);
  interpolator_ = {};
  speed_.reset();
  observations_.end_log();
  if (shift_) shift_.emplace(shift_->delay_s());
  T_first_this_.reset();
}

void ScanStream::connect(std::optional<Pose2>& T_odom_base) {
  if (!T_odom_base) return;
  if (opened_ > 1) {
    if (!T_first_this_) {
      T_first_this_ = T_odom_base_last_ ? *T_odom_base_last_ * inverse(*T_odom_base) : Pose2{};
    }
    T_odom_base = *T_first_this_ * *T_odom_base;
  }
  T_odom_base_last_ = T_odom_base;
}

NodKind ScanStream::nod_kind(std::size_t scans_ahead) {
  const auto kind_of = [](const LogRecord& record) {
    if (std::holds_alternative<Encoder>(record)) return NodKind::kEncoder;
    return std::holds_alternative<Tilt>(record) ? NodKind::kTilt : NodKind::kNone;
  };
  try {
    for (std::size_t scans = 0; scans < scans_ahead && ahead_.size() < kMostAhead;) {
      std::optional<LogRecord> record = reader_->next();
      if (!record) break;
      ahead_.push_back(std::move(*record));
      if (const NodKind kind = kind_of(ahead_.back()); kind != NodKind::kNone) return kind;
      if (std::holds_alternative<ScanRecord>(ahead_.back())) ++scans;
    }
  } catch (const Error&) {
    ahead_problem_ = std::current_exception();
  }
  return NodKind::kNone;
}

std::optional<LogRecord> ScanStream::next_record() {
  if (!ahead_.empty()) {
    std::optional<LogRecord> record = std::move(ahead_.front());
    ahead_.pop_front();
    return record;
  }
  if (ahead_problem_) std::rethrow_exception(std::exchange(ahead_problem_, nullptr));
  return reader_->next();
}

// ENCODER and TILT messages that the listener does not use cause a warning: they came too late in the log or are of the
// other kind.
void ScanStream::notify_listener(const LogRecord& record) {
  if (std::holds_alternative<ScanRecord>(record)) return;
  if (listener_.record && listener_.record(record)) return;
  const auto note = [this](const char* kind, double stamp_s) {
    if (unused_.count++ == 0) unused_.first = std::string(kind) + " at " + format_quantity(stamp_s, Unit::kSecond);
  };
  if (const auto* encoder = std::get_if<Encoder>(&record)) note("ENCODER", encoder->stamp_s);
  if (const auto* tilt = std::get_if<Tilt>(&record)) note("TILT", tilt->stamp_s);
}

// A malformed line after the wanted range is ignored.
bool ScanStream::feed_listener() {
  if (!reader_ || given_ < range_.count) return false;
  try {
    const std::optional<LogRecord> record = next_record();
    if (!record) return false;
    notify_listener(*record);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::optional<ScanRecord> ScanStream::next_with_odometry() {
  std::optional<ScanRecord> scan = interpolator_.next(false);
  while (!scan) {
    std::optional<LogRecord> record = next_record();
    if (!record) return interpolator_.next(true);
    notify_listener(*record);
    if (auto* found = std::get_if<ScanRecord>(&*record)) interpolator_.take(std::move(*found));
    if (const auto* odometry = std::get_if<Odometry>(&*record)) interpolator_.take(*odometry);
    scan = interpolator_.next(false);
  }
  return scan;
}

std::optional<ScanRecord> ScanStream::next_shifted() {
  while (true) {
    if (std::optional<ScanRecord> scan = shift_->next(false)) return scan;
    std::optional<ScanRecord> ahead = next_with_odometry();
    if (!ahead) return shift_->next(true);
    shift_->take(std::move(*ahead));
  }
}

std::optional<ScanRecord> ScanStream::next_of_all() {
  if (open_problem_) std::rethrow_exception(open_problem_);
  while (reader_) {
    std::optional<ScanRecord> scan = shift_ ? next_shifted() : next_with_odometry();
    if (scan) {
      ++read_;
      connect(scan->T_odom_base);
      state_beam_times(options_, scan->scan);
      speed_.complete(*scan);
      return scan;
    }
    open_next();
  }
  return std::nullopt;
}

std::optional<ScanRecord> ScanStream::next() {
  if (given_ == range_.count) return std::nullopt;
  for (std::uint64_t k = 0; !skipped_ && k < range_.skip; ++k) {
    if (!next_of_all()) break;
  }
  skipped_ = true;
  std::optional<ScanRecord> scan = next_of_all();
  if (!scan) return scan;
  ++given_;
  units_.add_ranges(scan->scan);
  if (scan->T_odom_base) units_.add_heading(scan->scan.stamp_s, scan->T_odom_base->theta_rad);
  return scan;
}

std::optional<Observation> ScanStream::next_observation() {
  std::optional<Observation> observation = observations_.next(false);
  try {
    while (!observation) {
      if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
      std::optional<ScanRecord> scan = next();
      if (!scan) return observations_.next(true);
      observations_.take(std::move(*scan));
      observation = observations_.next(false);
    }
  } catch (...) {
    observation = observations_.next(true);
    if (!observation) throw;
    problem_ = std::current_exception();
  }
  return observation;
}

double ScanStream::progress() const {
  const double of_range = static_cast<double>(given_) / static_cast<double>(range_.count);
  if (!reader_) return 1.0;
  const double of_log = reader_->progress();
  if (of_log < 0.0) return range_.count == ScanRange{}.count ? -1.0 : of_range;
  const double of_input = (static_cast<double>(opened_ - 1) + of_log) / static_cast<double>(paths_.size());
  return std::max(of_range, of_input);
}

std::vector<LogReader::Warning> ScanStream::warnings() const {
  std::vector<LogReader::Warning> list = earlier_warnings_;
  if (reader_) merge_warnings(list, reader_->warnings());
  if (unused_.count > 0) list.push_back(unused_);
  return list;
}

}  // namespace gdtslam
