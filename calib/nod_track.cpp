#include "gdtslam/calib/nod_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam::calib {
namespace {

// Knots less than half a turn apart are unambiguous; a quarter leaves a margin.
constexpr double kMostTurnsBetweenKnots = 0.25;

// An elevation in turns of ElevationTable::identity().
double turns_of_elevation(double elevation_rad) { return (elevation_rad + kPi) / kTwoPi; }

}  // namespace

NodTrack::NodTrack(const CrankEncoder& encoder, const NodTrackLimits& limits)
    : limits_(limits), encoder_(encoder), resolution_(1.0 / static_cast<double>(encoder.ticks_per_turn)) {}

NodTrack::NodTrack(const NodTrackLimits& limits) : limits_(limits), is_crank_(false) { encoder_.wraps = true; }

void NodTrack::take(const Encoder& message) {
  // With an index mark only the position within the turn counts, whatever the counter does with the turns. Without one
  // it counts from the first message's position within the turn: a count far from zero would cost digits.
  if (!first_ticks_ || encoder_.wraps) first_ticks_ = message.ticks;
  const auto since_first = static_cast<std::uint64_t>(message.ticks) - static_cast<std::uint64_t>(*first_ticks_);
  const double ticks = static_cast<double>(*first_ticks_ % encoder_.ticks_per_turn) +
                       static_cast<double>(static_cast<std::int64_t>(since_first));
  append(message.stamp_s, ticks / static_cast<double>(encoder_.ticks_per_turn));
}

void NodTrack::take(const Tilt& message) {
  if (!std::isfinite(message.elevation_rad)) {
    faults_.jumps.add(message.stamp_s);
    return;
  }
  append(message.stamp_s, turns_of_elevation(message.elevation_rad));
}

void NodTrack::append(double stamp_s, double measured_turns) {
  const double last_s = messages_.empty() ? -std::numeric_limits<double>::infinity() : messages_.back().stamp_s;
  if (!std::isfinite(stamp_s) || stamp_s <= last_s) {
    note_past(stamp_s, measured_turns);
    return;
  }
  past_.clear();
  Message message{stamp_s, measured_turns, false};
  if (!messages_.empty()) {
    const double turned = measured_turns - last_turns_;
    const double whole_turns = encoder_.wraps ? std::round(turned) : 0.0;
    message.turns = messages_.back().turns + (turned - whole_turns);
    message.is_joined = joins_last(stamp_s, turned - whole_turns);
    if (is_crank_ && message.is_joined && whole_turns != 0.0) faults_.wraps.add(stamp_s);
  }
  last_turns_ = measured_turns;
  messages_.push_back(message);
}

bool NodTrack::begins_again_at(double stamp_s) const {
  return past_.size() + 1 == kSetBack && stamp_s > past_.back().stamp_s && stamp_s <= messages_.back().stamp_s;
}

void NodTrack::note_past(double stamp_s, double measured_turns) {
  if (!std::isfinite(stamp_s)) {
    faults_.past_stamps.add(stamp_s);
    return;
  }
  const bool begins_again = begins_again_at(stamp_s);
  if (!past_.empty() && stamp_s <= past_.back().stamp_s) past_.clear();
  past_.push_back({stamp_s, measured_turns, false});
  if (!begins_again) {
    faults_.past_stamps.add(stamp_s);
    return;
  }
  faults_.past_stamps.count -= past_.size() - 2;  // they are used after all; the step itself counts once
  messages_.clear();
  for (const Message& message : std::exchange(past_, {})) append(message.stamp_s, message.turns);
}

bool NodTrack::joins_last(double stamp_s, double turned) {
  const double elapsed_s = stamp_s - messages_.back().stamp_s;
  if (elapsed_s > limits_.max_gap_s) {
    faults_.gaps.add(stamp_s);
    return false;
  }
  // One tick may occur between two messages, however close they are.
  if (std::fabs(turned) > limits_.max_turns_per_s * elapsed_s + resolution_) {
    faults_.jumps.add(stamp_s);
    return false;
  }
  if (is_crank_ && turned < 0.0) faults_.backwards.add(stamp_s);
  return true;
}

std::optional<double> NodTrack::known_until_s() const {
  if (messages_.empty()) return std::nullopt;
  return messages_.back().stamp_s;
}

double NodTrack::turns_at(std::size_t before, double stamp_s) const {
  const Message& low = messages_[before];
  if (stamp_s <= low.stamp_s) return low.turns;
  const Message& high = messages_[before + 1];
  return low.turns + (high.turns - low.turns) * ((stamp_s - low.stamp_s) / (high.stamp_s - low.stamp_s));
}

std::vector<PhaseKnot> NodTrack::knots(double stamp_s, double from_s, double to_s) const {
  // Written so that a time that is not a number is never covered.
  if (messages_.empty() ||
      !(from_s >= messages_.front().stamp_s && from_s <= to_s && to_s <= messages_.back().stamp_s)) {
    return {};
  }
  const auto is_before = [](const Message& message, double time_s) { return message.stamp_s < time_s; };
  const auto is_after = [](double time_s, const Message& message) { return time_s < message.stamp_s; };
  const auto to_index = [this](auto message) { return static_cast<std::size_t>(message - messages_.begin()); };
  const std::size_t first = to_index(std::upper_bound(messages_.begin(), messages_.end(), from_s, is_after)) - 1;
  const std::size_t last = to_index(std::lower_bound(messages_.begin(), messages_.end(), to_s, is_before));
  for (std::size_t i = first + 1; i <= last; ++i) {
    if (!messages_[i].is_joined) return {};
  }

  std::vector<PhaseKnot> knots;
  double last_s = from_s;
  double last_turns = turns_at(first, from_s);
  knots.push_back({from_s - stamp_s, phase_of_turns(last_turns)});
  const auto go_to = [&](double time_s, double turns) {
    const double pieces = std::max(1.0, std::ceil(std::fabs(turns - last_turns) / kMostTurnsBetweenKnots));
    for (double piece = 1.0; piece < pieces; piece += 1.0) {
      const double share = piece / pieces;
      knots.push_back(
          {last_s + (time_s - last_s) * share - stamp_s, phase_of_turns(last_turns + (turns - last_turns) * share)});
    }
    knots.push_back({time_s - stamp_s, phase_of_turns(turns)});
    last_s = time_s;
    last_turns = turns;
  };
  for (std::size_t i = first + 1; i < last; ++i) go_to(messages_[i].stamp_s, messages_[i].turns);
  go_to(to_s, last > first ? turns_at(last - 1, to_s) : last_turns);
  return knots;
}

void NodTrack::forget_before(double stamp_s) {
  // The last message at or before that time still bounds the range after it.
  while (messages_.size() >= 2 && messages_[1].stamp_s <= stamp_s) messages_.pop_front();
}

void NodTrack::Count::add(double stamp_s) {
  if (count++ == 0) first_stamp_s = stamp_s;
}

std::vector<LogReader::Warning> NodTrack::Faults::as_warnings() const {
  const std::array<std::pair<const char*, const Count*>, 4> kinds{{{"nodding runs backwards", &backwards},
                                                                   {"nodding jumps", &jumps},
                                                                   {"nodding messages missing", &gaps},
                                                                   {"nodding stamp in the past", &past_stamps}}};
  std::vector<LogReader::Warning> warnings;
  for (const auto& [kind, fault] : kinds) {
    if (fault->count == 0) continue;
    warnings.push_back({kind, fault->count, "at " + format_quantity(fault->first_stamp_s, Unit::kSecond)});
  }
  return warnings;
}

}  // namespace gdtslam::calib
