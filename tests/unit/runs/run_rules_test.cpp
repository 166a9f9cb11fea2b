// The thresholds of what is said of runs and of odometry, at and beside each of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/runs/folder/run_review.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

Trajectory metre_by_metre(std::size_t poses) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses; ++i) {
    trajectory.push_back({100.0 + static_cast<double>(i), {static_cast<double>(i), 0.0, 0.0}});
  }
  return trajectory;
}

RunDoubts doubts_with(std::vector<ClosedLoop> loops, const WheelReport& wheels = {},
                      std::vector<UncertainStretch> uncertain = {}) {
  RunDoubts doubts{.scans = 10, .accepted = 10, .loops = LoopFindings{}};
  doubts.loops->loops = std::move(loops);
  doubts.loops->wheels = wheels;
  doubts.loops->uncertain = std::move(uncertain);
  doubts.loops->searches = 4;
  if (doubts.loops->loops.empty()) {
    ClosedLoop loop;
    loop.to = 9;
    loop.weight = 1.0;
    loop.is_on = true;
    doubts.loops->loops = {loop};
  }
  return doubts;
}

std::vector<ReviewNote> notes_of(const RunDoubts& doubts) { return review_notes(doubts, metre_by_metre(10), {}); }
std::vector<ReviewNote> notes_of(const WheelReport& wheels) { return notes_of(doubts_with({}, wheels)); }

TEST(RunRules, ALoopIsOffByLittleBelowFortyCentimetres) {
  const auto advice_at = [](double off_m) {
    ClosedLoop loop;
    loop.to = 9;
    loop.off_m = off_m;
    return notes_of(doubts_with({loop})).at(0).advice;
  };
  EXPECT_EQ(kUncertain_m, 0.2);
  EXPECT_THAT(advice_at(0.399), HasSubstr("off by little"));
  EXPECT_THAT(advice_at(0.4), HasSubstr("two places look alike"));
}

TEST(RunRules, WheelsAreTalkedOfBeyondThreeDeviationsAndOnePercent) {
  const auto count = [](const WheelReport& wheels) { return notes_of(wheels).size(); };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(count({.distance = sign * 0.0101, .sigma_distance = 0.003}), 1U);
    EXPECT_EQ(count({.distance = sign * 0.0099, .sigma_distance = 0.003}), 0U);
    EXPECT_EQ(count({.distance = sign * 0.0301, .sigma_distance = 0.01}), 1U);
    EXPECT_EQ(count({.distance = sign * 0.0299, .sigma_distance = 0.01}), 0U);
    EXPECT_EQ(count({.turn = sign * 0.0101, .sigma_turn = 0.003}), 1U);
    EXPECT_EQ(count({.turn = sign * 0.0099, .sigma_turn = 0.003}), 0U);
    EXPECT_EQ(count({.turn = sign * 0.0299, .sigma_turn = 0.01}), 0U);
    // 20 cm to the side over 15 m: 2 * 0.2 / 225 of a radian a metre.
    const double worth = 0.4 / 225.0;
    EXPECT_EQ(count({.turn_rad_per_m = sign * 1.01 * worth, .sigma_rad_per_m = 0.3 * worth}), 1U);
    EXPECT_EQ(count({.turn_rad_per_m = sign * 0.99 * worth, .sigma_rad_per_m = 0.3 * worth}), 0U);
    EXPECT_EQ(count({.turn_rad_per_m = sign * 2.9 * worth, .sigma_rad_per_m = worth}), 0U);
  }
  EXPECT_THAT(notes_of(WheelReport{.distance = -0.05}).at(0).finding, HasSubstr("5.0 % too long"));
  EXPECT_THAT(notes_of(WheelReport{.turn = 0.05}).at(0).finding, HasSubstr("5.0 % too small"));
  EXPECT_THAT(notes_of(WheelReport{.turn = 0.05}).at(0).advice, HasSubstr("turns by 1.050"));
}

TEST(RunRules, WheelsSlipBeyondFourTimesTheVarianceWhereThatIsKnown) {
  const auto count = [](double of_wheels, double of_matches) {
    WheelReport wheels;
    wheels.variance_factor = of_wheels;
    wheels.variance_factor_of_matches = of_matches;
    return notes_of(wheels).size();
  };
  EXPECT_EQ(count(4.0, 1.0), 0U);
  EXPECT_EQ(count(4.01, 1.0), 1U);
  EXPECT_EQ(count(4.01, 0.1), 0U) << "a tenth is where it is cut off";
  EXPECT_EQ(count(4.01, 0.1001), 1U);
}

TEST(RunRules, AStretchIsAdvisedByWhereItLies) {
  const auto advice = [](std::size_t from, std::size_t to) {
    return notes_of(doubts_with({}, {}, {{from, to, 0.5}})).at(0).advice;
  };
  EXPECT_THAT(advice(0, 3), HasSubstr("come back to where the drive began"));
  EXPECT_THAT(advice(1, 8), HasSubstr("drive there again"));
  EXPECT_THAT(advice(1, 9), HasSubstr("end the drive at a place that it has seen before"));
  EXPECT_THAT(advice(0, 9), HasSubstr("drive the way again in loops"));
}

TEST(RunRules, TheWorstPoseOfAStretchIsTheFirstOfEquals) {
  std::vector<PoseCovariance> covariances(10, PoseCovariance{.xx = 0.09, .yy = 0.04});
  const RunDoubts doubts = doubts_with({}, {}, {{3, 6, 0.5}});
  EXPECT_EQ(review_notes(doubts, metre_by_metre(10), covariances).at(0).at_m, Point2(3.0, 0.0));
  covariances[6].yy = 0.16;
  EXPECT_EQ(review_notes(doubts, metre_by_metre(10), covariances).at(0).at_m, Point2(6.0, 0.0));
  covariances[7].xx = 0.25;
  EXPECT_EQ(review_notes(doubts, metre_by_metre(10), covariances).at(0).at_m, Point2(6.0, 0.0)) << "beyond it";
}

TEST(RunRules, OneIsSaidAsOne) {
  RunDoubts doubts = doubts_with({});
  doubts.refused = 1;
  doubts.restarts = 1;
  const std::vector<ReviewNote> notes = review_notes(doubts, metre_by_metre(10), {});
  EXPECT_THAT(notes.at(0).finding, HasSubstr("1 of 10 scans was refused, 10.0 %"));
  EXPECT_THAT(notes.at(1).finding, HasSubstr("went on once"));
  doubts = doubts_with({});
  doubts.loops->loops.clear();
  doubts.loops->searches = 1;
  EXPECT_THAT(review_notes(doubts, metre_by_metre(10), {}).at(0).finding, HasSubstr("in 1 search:"));
  EXPECT_EQ(percent_text(1, 100), "1.0 %");
  EXPECT_EQ(percent_text(1, 101), "0.99 %");
}

/// A robot whose heading swings by `size_rad`, seen by scans and wheels at the same moments.
std::vector<TimedHeading> swinging(double size_rad, int scans, double period_s) {
  std::vector<TimedHeading> headings;
  for (int k = 0; k < scans; ++k) {
    const double heading = size_rad * std::sin(0.9 * period_s * k);
    headings.push_back({period_s * k, heading, heading});
  }
  return headings;
}

TEST(OdometryDelayRules, ThreeRadiansOfTurnsAreWanted) {
  // Steps of 0.1 rad to and fro, of which 30 are just enough.
  std::vector<TimedHeading> headings;
  for (int k = 0; k <= 30; ++k) headings.push_back({0.2 * k, k % 2 == 0 ? 0.0 : 0.1, k % 2 == 0 ? 0.0 : 0.10001});
  EXPECT_TRUE(delay_of(headings));
  headings.pop_back();
  EXPECT_FALSE(delay_of(headings));
}

TEST(OdometryDelayRules, ScansMoreThanASecondApartTellNothing) {
  EXPECT_TRUE(delay_of(swinging(1.0, 200, 0.99)));
  EXPECT_FALSE(delay_of(swinging(1.0, 200, 1.01)));
}

TEST(OdometryDelayRules, StandsOutBeyondChanceSizeAndGain) {
  const OdometryDelay good{.delay_s = 0.02, .sigma_s = 0.0039, .gain = 3.1};
  EXPECT_TRUE(good.stands_out());
  EXPECT_TRUE((OdometryDelay{.delay_s = -0.02, .sigma_s = 0.0039, .gain = 3.1}.stands_out()));
  EXPECT_FALSE((OdometryDelay{.delay_s = 0.0199, .sigma_s = 0.001, .gain = 3.1}.stands_out()));
  EXPECT_FALSE((OdometryDelay{.delay_s = -0.0199, .sigma_s = 0.001, .gain = 3.1}.stands_out()));
  EXPECT_FALSE((OdometryDelay{.delay_s = 0.02, .sigma_s = 0.0041, .gain = 3.1}.stands_out()));
  EXPECT_FALSE((OdometryDelay{.delay_s = 0.02, .sigma_s = 0.0039, .gain = 3.0}.stands_out()));
}

ScanRecord scan_at_x(double stamp_s, double x_m) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.T_odom_base = Pose2{x_m, 0.0, 0.0};
  return record;
}

TEST(OdometryShiftRules, AScanWaitsUntilItsOdometryIsThere) {
  OdometryShift shift(0.25);
  EXPECT_EQ(shift.delay_s(), 0.25);
  EXPECT_FALSE(shift.next(true));
  shift.take(scan_at_x(0.0, 0.0));
  EXPECT_FALSE(shift.next(false));
  shift.take(scan_at_x(0.125, 1.0));
  EXPECT_FALSE(shift.next(false));
  shift.take(scan_at_x(0.25, 2.0));
  const auto first = shift.next(false);  // at the very moment
  ASSERT_TRUE(first);
  EXPECT_EQ(first->T_odom_base->x_m, 2.0);
  EXPECT_FALSE(shift.next(false));
  // A stamp that does not go on is no odometry of the track.
  shift.take(scan_at_x(0.25, 50.0));
  EXPECT_EQ(shift.next(true)->T_odom_base->x_m, 2.0);
}

TEST(OdometryShiftRules, NoMoreThanSoManyWait) {
  OdometryShift shift(1.0e6);
  for (int k = 0; k < 511; ++k) shift.take(scan_at_x(0.001 * k, k));
  EXPECT_FALSE(shift.next(false));
  shift.take(scan_at_x(0.511, 511.0));
  const auto first = shift.next(false);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->T_odom_base->x_m, 511.0) << "the last that is known";
  EXPECT_FALSE(shift.next(false));
}

TEST(OdometryShiftRules, OfALongDriveTheNewestIsKept) {
  OdometryShift shift(-1000.0);  // wants what was long ago
  std::optional<ScanRecord> last;
  for (int k = 0; k <= 5000; ++k) {
    shift.take(scan_at_x(0.5 * k, k));
    while (auto scan = shift.next(false)) last = scan;
  }
  ASSERT_TRUE(last);
  // The track holds 4096; the scan at 2500 s wants 1500 s, which is pose 3000.
  EXPECT_EQ(last->T_odom_base->x_m, 3000.0);
  OdometryShift farther(-2400.0);
  for (int k = 0; k <= 5000; ++k) {
    farther.take(scan_at_x(0.5 * k, k));
    while (auto scan = farther.next(false)) last = scan;
  }
  EXPECT_EQ(last->T_odom_base->x_m, 5000.0 - 4095.0) << "100 s is too long ago";
}

TEST(LinkageRules, WhatIsSupposedHasToBeStatedWhereTheCrankCannotTurn) {
  const auto refusal = [](const std::string& lines) -> std::string {
    try {
      static_cast<void>(read_linkage_text("gdtslam_linkage: 1\n" + lines, "l.yaml"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string bars = "bars: {crank: 6 cm, coupler: 8.5 cm, rocker: 8.8 cm, ground: 12 cm}\n";
  EXPECT_THAT(refusal(bars + "elevation: {offset: 10 deg}\n"), HasSubstr("or give encoder.zero too"));
  EXPECT_THAT(refusal(bars + "encoder: {zero: 1 deg}\n"), HasSubstr("or give elevation.offset too"));
  EXPECT_THAT(refusal(bars + "encoder: {direction: -1}\nelevation: {offset: 10 deg}\n"),
              HasSubstr("or give encoder.zero too"));
  EXPECT_EQ(refusal("preset: paper-b\nencoder: {ticks_per_turn: 1e15}\n").find("whole number"), std::string::npos);
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks_per_turn: 1.1e15}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks_per_turn: -1.1e15}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal("preset: paper-b\nelevation: {sign: 0}\n"), HasSubstr("must be 1 or -1"));
  EXPECT_EQ(refusal("preset: paper-b\nuncertainty: {crank: 0 mm}\n"), "accepted") << "exactly known";
}

TEST(LinkageRules, ASidecarHasTheLogsNameWithoutItsEndings) {
  for (const char* log : {"a/drive", "a/drive.log", "a/drive.clf.gz", "a/drive.log.bz2", "a/drive.csv.zst",
                          "a/drive.jsonl.xz", "a/drive.mcap", "a/drive.bag", "a/drive.db3", "a/drive/"}) {
    EXPECT_EQ(sidecar_path(log, ".linkage.yaml"), "a/drive.linkage.yaml") << log;
  }
  EXPECT_EQ(sidecar_path("a/drive.txt", ".x"), "a/drive.txt.x");
  EXPECT_EQ(linkage_sidecar("-"), "");
}

}  // namespace
}  // namespace gdtslam
