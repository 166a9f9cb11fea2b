// Each fault of an encoder has the outcome that nod_track.hpp states.
#include "gdtslam/calib/nod_track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kPhase = 4294967296.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CrankEncoder encoder_of(std::int64_t ticks_per_turn, bool wraps) {
  CrankEncoder encoder;
  encoder.ticks_per_turn = ticks_per_turn;
  encoder.wraps = wraps;
  return encoder;
}

// A track of 1000 ticks a turn with a message each 0.1 s from time 100.
NodTrack track_of(const std::vector<std::int64_t>& ticks, bool wraps = true, double first_s = 100.0) {
  NodTrack track(encoder_of(1000, wraps), {});
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    track.take(Encoder{first_s + 0.1 * static_cast<double>(i), ticks[i]});
  }
  return track;
}

// Turns at one time, in [0, 1); not a number where the track does not cover it.
double turns_at(const NodTrack& track, double time_s) {
  const std::vector<PhaseKnot> knots = track.knots(time_s, time_s, time_s);
  if (knots.empty()) return kNan;
  EXPECT_THAT(knots, SizeIs(2));
  EXPECT_EQ(knots[0].phase, knots[1].phase);
  EXPECT_EQ(knots[0].offset_s, 0.0);
  return static_cast<double>(knots[0].phase) / kPhase;
}

TEST(NodTrack, InterpolatesBetweenMessagesAndNowhereElse) {
  const NodTrack track = track_of({100, 110, 130});
  EXPECT_NEAR(turns_at(track, 100.0), 0.100, 1e-9);
  EXPECT_NEAR(turns_at(track, 100.05), 0.105, 1e-9);
  EXPECT_NEAR(turns_at(track, 100.15), 0.120, 1e-9);
  EXPECT_NEAR(turns_at(track, 100.2), 0.130, 1e-9);
  EXPECT_TRUE(std::isnan(turns_at(track, 99.999)));
  EXPECT_TRUE(std::isnan(turns_at(track, 100.201)));
  EXPECT_THAT(track.knots(100.0, 99.99, 100.1), IsEmpty());
  EXPECT_THAT(track.knots(100.0, 100.1, 100.3), IsEmpty());
  EXPECT_THAT(track.knots(100.0, 100.1, 100.05), IsEmpty());
  EXPECT_THAT(track.knots(100.0, kNan, 100.05), IsEmpty());
  EXPECT_THAT(track.knots(100.0, 100.0, kNan), IsEmpty());
}

TEST(NodTrack, KnotsAreTheEndsAndTheMessagesBetween) {
  const NodTrack track = track_of({0, 10, 30, 60});
  const std::vector<PhaseKnot> knots = track.knots(100.1, 100.05, 100.25);
  ASSERT_THAT(knots, SizeIs(4));
  const std::vector<double> offsets_s{-0.05, 0.0, 0.1, 0.15};
  const std::vector<double> turns{0.005, 0.010, 0.030, 0.045};
  for (std::size_t i = 0; i < knots.size(); ++i) {
    EXPECT_NEAR(knots[i].offset_s, offsets_s[i], 1e-9);
    EXPECT_NEAR(static_cast<double>(knots[i].phase) / kPhase, turns[i], 1e-9);
  }
}

TEST(NodTrack, WrapsAtTheIndexMarkForwards) {
  const NodTrack track = track_of({980, 995, 10, 25});
  EXPECT_NEAR(turns_at(track, 100.15), 0.0025, 1e-9);  // 995 to 1010
  EXPECT_NEAR(turns_at(track, 100.25), 0.0175, 1e-9);
  EXPECT_EQ(track.faults().wraps.count, 1U);
  EXPECT_NEAR(track.faults().wraps.first_stamp_s, 100.2, 1e-9);
  EXPECT_THAT(track.faults().as_warnings(), IsEmpty());
}

TEST(NodTrack, WrapsAtTheIndexMarkBackwards) {
  const NodTrack track = track_of({10, 995, 980});
  EXPECT_NEAR(turns_at(track, 100.05), 0.0025, 1e-9);  // 10 to -5
  EXPECT_EQ(track.faults().wraps.count, 1U);
  EXPECT_EQ(track.faults().backwards.count, 2U);
  EXPECT_EQ(track.faults().jumps.count, 0U);
}

TEST(NodTrack, WithoutIndexMarkAFallOfATurnIsAJump) {
  const NodTrack track = track_of({980, 995, 10, 25}, false);
  EXPECT_TRUE(std::isnan(turns_at(track, 100.15)));
  EXPECT_NEAR(turns_at(track, 100.25), 0.0175, 1e-9);
  EXPECT_EQ(track.faults().jumps.count, 1U);
  EXPECT_EQ(track.faults().wraps.count, 0U);
}

// Between knots the short way is taken, so that a stretch of more than half a turn needs knots within.
TEST(NodTrack, KnotsAreLessThanHalfATurnApart) {
  NodTrack track(encoder_of(1000, false), {});
  track.take(Encoder{0.0, 0});
  track.take(Encoder{0.2, 900});
  const std::vector<PhaseKnot> knots = track.knots(0.0, 0.0, 0.2);
  ASSERT_GE(knots.size(), 3U);
  double turned = 0.0;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const auto step = static_cast<std::int32_t>(knots[i].phase - knots[i - 1].phase);
    turned += step / kPhase;
    EXPECT_NEAR(turned, 4.5 * knots[i].offset_s, 1e-9);
  }
  EXPECT_NEAR(turned, 0.9, 1e-9);
}

TEST(NodTrack, AJumpLeavesTheTimeBetweenUncovered) {
  NodTrackLimits limits;
  limits.max_turns_per_s = 2.0;  // 200 ticks in 0.1 s
  NodTrack track(encoder_of(1000, true), limits);
  const std::vector<std::int64_t> ticks{0, 10, 330, 340};
  for (std::size_t i = 0; i < ticks.size(); ++i) track.take(Encoder{0.1 * static_cast<double>(i), ticks[i]});
  EXPECT_NEAR(turns_at(track, 0.05), 0.005, 1e-9);
  EXPECT_NEAR(turns_at(track, 0.1), 0.010, 1e-9);
  EXPECT_TRUE(std::isnan(turns_at(track, 0.15)));
  EXPECT_NEAR(turns_at(track, 0.2), 0.330, 1e-9);
  EXPECT_NEAR(turns_at(track, 0.25), 0.335, 1e-9);
  EXPECT_THAT(track.knots(0.0, 0.05, 0.25), IsEmpty());
  EXPECT_EQ(track.faults().jumps.count, 1U);
  EXPECT_EQ(track.faults().gaps.count, 0U);
}

TEST(NodTrack, MissingMessagesLeaveAGap) {
  NodTrack track(encoder_of(1000, true), {});
  for (const double time_s : {0.0, 0.25, 0.51, 0.6}) track.take(Encoder{time_s, 10});
  EXPECT_FALSE(std::isnan(turns_at(track, 0.2)));  // exactly max_gap_s
  EXPECT_TRUE(std::isnan(turns_at(track, 0.3)));
  EXPECT_FALSE(std::isnan(turns_at(track, 0.55)));
  EXPECT_EQ(track.faults().gaps.count, 1U);
  EXPECT_NEAR(track.faults().gaps.first_stamp_s, 0.51, 1e-9);
}

TEST(NodTrack, MessagesInThePastAreDropped) {
  NodTrack track = track_of({0, 10, 20});
  track.take(Encoder{100.15, 500});
  track.take(Encoder{100.2, 600});  // the same time as the last one
  track.take(Encoder{kNan, 700});
  track.take(Encoder{std::numeric_limits<double>::infinity(), 800});
  track.take(Encoder{100.3, 30});
  EXPECT_NEAR(turns_at(track, 100.25), 0.025, 1e-9);
  EXPECT_EQ(track.faults().past_stamps.count, 4U);
  EXPECT_EQ(track.faults().past_stamps.first_stamp_s, 100.15);
  EXPECT_EQ(track.faults().jumps.count, 0U);
}

TEST(NodTrack, WithoutIndexMarkACountFarFromZeroCostsNoDigits) {
  constexpr std::int64_t kFar = 9'000'000'000'000'000'000;
  const NodTrack track = track_of({kFar + 100, kFar + 110, kFar + 130}, false);
  EXPECT_NEAR(turns_at(track, 100.05), 0.105, 1e-9);
  EXPECT_NEAR(turns_at(track, 100.15), 0.120, 1e-9);
  const NodTrack below = track_of({-kFar - 100, -kFar - 90, -kFar - 70}, false);
  EXPECT_NEAR(turns_at(below, 100.15), 0.920, 1e-9);
}

// The ends of 64 bits are as far from each other as can be: a jump, whichever way, and no overflow.
TEST(NodTrack, TheFurthestCountsAreJumps) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const NodTrack track = track_of({0, kMost, 1, -kMost, 2}, false);
  EXPECT_EQ(track.faults().jumps.count, 4U);
}

TEST(NodTrack, FiveMessagesInARowThatGoForwardInThePastSetTheClockBack) {
  NodTrack track = track_of({100, 110, 120, 130, 140, 150, 160, 170});  // up to 100.7
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(track.begins_again_at(100.25 + 0.1 * k), k == 4);
    track.take(Encoder{100.25 + 0.1 * k, 500 + 10 * k});
    EXPECT_NEAR(turns_at(track, 100.45), k < 4 ? 0.145 : 0.520, 1e-9) << k;
  }
  EXPECT_EQ(track.known_until_s(), 100.65);
  EXPECT_TRUE(std::isnan(turns_at(track, 100.2)));
  EXPECT_EQ(track.faults().past_stamps.count, 1U);
  EXPECT_EQ(track.faults().past_stamps.first_stamp_s, 100.25);
  track.take(Encoder{100.75, 550});
  EXPECT_NEAR(turns_at(track, 100.7), 0.545, 1e-9);
}

TEST(NodTrack, FewerThanFiveOrOutOfOrderDoNot) {
  NodTrack track = track_of({100, 110, 120, 130, 140, 150, 160, 170});
  for (const double stamp_s : {100.1, 100.2, 100.3, 100.4, 100.35, 100.4, 100.5, 100.6})
    track.take(Encoder{stamp_s, 500});
  track.take(Encoder{100.8, 180});
  for (const double stamp_s : {100.1, 100.2, 100.3, 100.4}) track.take(Encoder{stamp_s, 500});
  EXPECT_EQ(track.faults().past_stamps.count, 12U);
  EXPECT_NEAR(turns_at(track, 100.15), 0.115, 1e-9);
}

TEST(NodTrack, OneStampFarAheadIsForgotten) {
  NodTrack track = track_of({100, 110, 120});
  track.take(Encoder{1e12, 130});
  for (int k = 0; k < 10; ++k) track.take(Encoder{100.3 + 0.1 * k, 130 + 10 * k});
  EXPECT_NEAR(turns_at(track, 100.35), 0.135, 1e-9);
  EXPECT_EQ(track.faults().past_stamps.count, 1U);
  EXPECT_EQ(track.faults().gaps.count, 1U);
}

TEST(NodTrack, MemoryIsBoundedByForgetting) {
  NodTrack track(encoder_of(20000, true), {});
  std::size_t most = 0;
  for (std::int64_t i = 0; i < 200'000; ++i) {
    const double time_s = 0.01 * static_cast<double>(i);
    track.take(Encoder{time_s, (i * 37) % 20000});
    track.forget_before(time_s - 1.0);
    most = std::max(most, track.kept_messages());
  }
  EXPECT_LE(most, 103U);
  EXPECT_EQ(track.faults().wraps.count, 199'999U * 37U / 20'000U);
  EXPECT_THAT(track.faults().as_warnings(), IsEmpty());
}

TEST(NodTrack, TiltGivesTheElevationThroughTheIdentityTable) {
  NodTrack track(NodTrackLimits{});
  track.take(Tilt{0.0, -0.5});
  track.take(Tilt{0.1, 0.3});
  track.take(Tilt{0.2, 0.1});  // a tilting laser goes down again: no fault
  const ElevationTable table = ElevationTable::identity();
  const auto elevation_rad = [&](double time_s) {
    return table.elevation_rad(track.knots(0.0, time_s, time_s)[0].phase);
  };
  EXPECT_NEAR(elevation_rad(0.0), -0.5, 2e-9);
  EXPECT_NEAR(elevation_rad(0.05), -0.1, 2e-9);
  EXPECT_NEAR(elevation_rad(0.15), 0.2, 2e-9);
  EXPECT_THAT(track.faults().as_warnings(), IsEmpty());
}

TEST(NodTrack, TiltPassesHalfATurn) {
  NodTrack track(NodTrackLimits{});
  track.take(Tilt{0.0, kPi - 0.1});
  track.take(Tilt{0.1, -kPi + 0.3});
  const double elevation_rad = ElevationTable::identity().elevation_rad(track.knots(0.0, 0.05, 0.05)[0].phase);
  EXPECT_NEAR(elevation_rad, -kPi + 0.1, 2e-9);
  EXPECT_EQ(track.faults().wraps.count, 0U);
}

TEST(NodTrack, AnElevationThatIsNotFiniteIsDropped) {
  NodTrack track(NodTrackLimits{});
  track.take(Tilt{0.0, 0.0});
  track.take(Tilt{0.1, kNan});
  track.take(Tilt{0.2, 0.2});
  EXPECT_EQ(track.faults().jumps.count, 1U);
  EXPECT_EQ(track.kept_messages(), 2U);
}

}  // namespace
}  // namespace gdtslam::calib
