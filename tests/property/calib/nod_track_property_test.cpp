// Random courses of a crank, sampled, cut to ticks, wrapped, with messages lost: what the track says equals the course
// at the messages and stays within its bound between, covered is what the definition says, forgetting changes nothing.
#include "gdtslam/calib/nod_track.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace gdtslam::calib {
namespace {

constexpr double kPhase = 4294967296.0;

// Turns over time: even, with a swing on it that may turn the crank back.
struct Course {
  double start = 0.0;
  double rate = 0.0;
  double swing = 0.0;
  double swing_rate = 0.0;
  [[nodiscard]] double at(double time_s) const { return start + rate * time_s + swing * std::sin(swing_rate * time_s); }
  [[nodiscard]] double most_acceleration() const { return swing * swing_rate * swing_rate; }
};

struct Sampled {
  Course course;
  CrankEncoder encoder;
  std::vector<Encoder> messages;  ///< as the log has them
  std::vector<double> turns;      ///< their ticks as turns, unwrapped
};

double real(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 1'000'001) / 1e6); }

std::int64_t floor_mod(std::int64_t value, std::int64_t modulus) {
  const std::int64_t rest = value % modulus;
  return rest < 0 ? rest + modulus : rest;
}

Sampled sampled_course() {
  Sampled result;
  result.course = {real(-3.0, 3.0), real(-1.0, 1.0), real(0.0, 0.05), real(0.0, 12.0)};
  result.encoder.ticks_per_turn = *rc::gen::inRange<std::int64_t>(500, 100'000);
  result.encoder.wraps = *rc::gen::arbitrary<bool>();
  double time_s = real(0.0, 2e9);
  const double first_s = time_s;
  const int count = *rc::gen::inRange(2, 120);
  for (int i = 0; i < count; ++i) {
    const bool is_lost_run = *rc::gen::inRange(0, 12) == 0;
    time_s += is_lost_run ? real(0.05, 0.6) : real(0.004, 0.05);
    const double ticks =
        std::floor(result.course.at(time_s - first_s) * static_cast<double>(result.encoder.ticks_per_turn));
    const auto whole = static_cast<std::int64_t>(ticks);
    result.messages.push_back({time_s, result.encoder.wraps ? floor_mod(whole, result.encoder.ticks_per_turn) : whole});
    result.turns.push_back(ticks / static_cast<double>(result.encoder.ticks_per_turn));
  }
  return result;
}

// Distance on the circle of one turn.
double apart(Phase phase, double turns) {
  const double difference = static_cast<double>(phase) / kPhase - turns;
  return std::fabs(difference - std::round(difference));
}

RC_GTEST_PROP(NodTrackProperty, EqualsTheCourseAtMessagesAndStaysWithinItsBoundBetween, ()) {
  const Sampled log = sampled_course();
  NodTrack track(log.encoder, {});
  for (const Encoder& message : log.messages) track.take(message);
  for (std::size_t i = 0; i < log.messages.size(); ++i) {
    const double time_s = log.messages[i].stamp_s;
    const auto knots = track.knots(time_s, time_s, time_s);
    RC_ASSERT(knots.size() == 2U);
    RC_ASSERT(apart(knots.front().phase, log.turns[i]) < 1e-9);
  }
  for (std::size_t i = 1; i < log.messages.size(); ++i) {
    const double low_s = log.messages[i - 1].stamp_s;
    const double high_s = log.messages[i].stamp_s;
    const double middle_s = low_s + (high_s - low_s) * real(0.0, 1.0);
    const auto knots = track.knots(low_s, middle_s, middle_s);
    const bool is_end = middle_s == low_s || middle_s == high_s;
    RC_ASSERT(is_end || knots.empty() == (high_s - low_s > NodTrackLimits{}.max_gap_s));
    if (knots.empty()) continue;
    const double share = (middle_s - low_s) / (high_s - low_s);
    const double line = log.turns[i - 1] + share * (log.turns[i] - log.turns[i - 1]);
    RC_ASSERT(apart(knots.front().phase, line) < 1e-9);
  }
}

// The line between two messages is off the course by a tick and an eighth of the acceleration over the gap squared.
RC_GTEST_PROP(NodTrackProperty, TheCourseIsWithinATickAndItsBend, ()) {
  const Course course{real(-3.0, 3.0), real(-1.0, 1.0), real(0.0, 0.05), real(0.0, 12.0)};
  CrankEncoder encoder;
  encoder.ticks_per_turn = *rc::gen::inRange<std::int64_t>(500, 100'000);
  const double ticks_per_turn = static_cast<double>(encoder.ticks_per_turn);
  const double step_s = real(0.004, 0.1);
  NodTrack track(encoder, {});
  for (int i = 0; i < 60; ++i) {
    const double time_s = step_s * i;
    const auto ticks = static_cast<std::int64_t>(std::floor(course.at(time_s) * ticks_per_turn));
    track.take(Encoder{time_s, floor_mod(ticks, encoder.ticks_per_turn)});
  }
  const double bound = 1.0 / ticks_per_turn + course.most_acceleration() * step_s * step_s / 8.0 + 1e-9;
  for (int i = 0; i < 50; ++i) {
    const double time_s = real(0.0, step_s * 58.9);
    const auto knots = track.knots(0.0, time_s, time_s);
    RC_ASSERT(knots.size() == 2U);
    RC_ASSERT(apart(knots.front().phase, course.at(time_s)) <= bound);
  }
  RC_ASSERT(track.faults().jumps.count == 0U);
  RC_ASSERT(track.faults().gaps.count == 0U);
}

RC_GTEST_PROP(NodTrackProperty, KnotsCoverTheirStretchInOrderAndForgettingChangesNothing, ()) {
  const Sampled log = sampled_course();
  NodTrack all(log.encoder, {});
  NodTrack forgetful(log.encoder, {});
  double forgotten_s = log.messages.front().stamp_s;
  for (const Encoder& message : log.messages) {
    all.take(message);
    forgetful.take(message);
    if (*rc::gen::inRange(0, 4) == 0) {
      forgotten_s = std::max(forgotten_s, message.stamp_s - real(0.0, 0.5));
      forgetful.forget_before(forgotten_s);
    }
  }
  const double from_s = forgotten_s + real(0.0, 0.3);
  const double to_s = from_s + real(0.0, 0.3);
  const auto knots = all.knots(from_s, from_s, to_s);
  const auto same = forgetful.knots(from_s, from_s, to_s);
  RC_ASSERT(knots.size() == same.size());
  for (std::size_t i = 0; i < knots.size(); ++i) {
    RC_ASSERT(knots[i].offset_s == same[i].offset_s);
    RC_ASSERT(knots[i].phase == same[i].phase);
    // In two steps: within RC_ASSERT both sides of an `or` are computed.
    const bool is_in_order = i == 0 || knots[i].offset_s >= knots[i - 1].offset_s;
    RC_ASSERT(is_in_order);
  }
  bool is_covered = to_s <= log.messages.back().stamp_s;
  for (std::size_t i = 1; i < log.messages.size(); ++i) {
    const double low_s = log.messages[i - 1].stamp_s;
    const double high_s = log.messages[i].stamp_s;
    const bool overlaps = low_s < to_s && high_s > from_s;
    if (overlaps && high_s - low_s > NodTrackLimits{}.max_gap_s) is_covered = false;
  }
  RC_ASSERT(knots.empty() == !is_covered);
  if (is_covered) {
    RC_ASSERT(knots.size() >= 2U);
    RC_ASSERT(knots.front().offset_s == 0.0);
    RC_ASSERT(knots.back().offset_s == to_s - from_s);
  }
}

}  // namespace
}  // namespace gdtslam::calib
