// What the messages of a nodding mount tell of it.
#include <fmt/format.h>

#include <algorithm>

#include "gdtslam/calib/nod_track.hpp"
#include "log_check.hpp"

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

}  // namespace gdtslam
