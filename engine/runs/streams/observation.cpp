#include "observation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kShareOfNewGap = 0.2;  // in the mean
constexpr double kClearPause = 2.0;     // times as long as every other: jitter does not change the order

}  // namespace

bool ObservationCollector::is_active(const Laser& laser) const {
  return count_ - laser.last_observation <= kActiveObservations;
}

bool ObservationCollector::has_scan_of(std::size_t laser) const {
  return std::any_of(scans_.begin(), scans_.end(), [laser](const ScanRecord& scan) { return scan.laser == laser; });
}

// False where a stamp is not a number, too.
bool ObservationCollector::has_room_for(const ScanRecord& scan) const {
  return scans_.size() < kMostLasers && std::fabs(scan.scan.stamp_s - scans_.front().scan.stamp_s) < kLongest_s;
}

bool ObservationCollector::is_complete() const {
  return std::all_of(lasers_.begin(), lasers_.end(),
                     [this](const auto& laser) { return !is_active(laser.second) || has_scan_of(laser.first); });
}

ObservationCollector::Laser& ObservationCollector::laser_of(std::size_t number) {
  const auto known =
      std::find_if(lasers_.begin(), lasers_.end(), [number](const auto& laser) { return laser.first == number; });
  if (known != lasers_.end()) return known->second;
  if (lasers_.size() >= kMostLasers) lasers_.erase(lasers_.begin());
  return lasers_.emplace_back(number, Laser{}).second;
}

void ObservationCollector::take(ScanRecord scan) {
  const double stamp_s = scan.scan.stamp_s;
  if (!scans_.empty() && (!has_room_for(scan) || has_scan_of(scan.laser) || first_ == scan.laser)) finish();
  Laser& laser = laser_of(scan.laser);
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

}  // namespace gdtslam
