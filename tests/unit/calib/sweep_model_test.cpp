// The sweep model's conventions: ticks, direction, continuity, timing, and what is refused.
#include "gdtslam/calib/sweep_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(CrankEncoder, TicksTurnTheCrankFromItsZero) {
  CrankEncoder encoder;
  encoder.ticks_per_turn = 20000;
  encoder.zero_rad = 0.5;
  EXPECT_NEAR(crank_rad(encoder, 0.0), 0.5, 1e-15);
  EXPECT_NEAR(crank_rad(encoder, 100.0), 0.5 + rad_from_deg(1.8), 1e-15);
  EXPECT_NEAR(crank_rad(encoder, 10000.5), 0.5 + kPi + rad_from_deg(0.009), 1e-14);
  encoder.direction = -1;
  EXPECT_NEAR(crank_rad(encoder, 5000.0), 0.5 - kPi / 2.0, 1e-15);
}

// The phase counts ticks, whatever way the crank turns.
TEST(CrankEncoder, PhaseIsTheShareOfATurn) {
  CrankEncoder encoder;
  encoder.ticks_per_turn = 1000;
  encoder.direction = -1;
  EXPECT_EQ(phase_of_ticks(encoder, 250.0), 0x40000000U);
  EXPECT_EQ(phase_of_ticks(encoder, 1250.0), 0x40000000U);
  EXPECT_EQ(phase_of_ticks(encoder, -250.0), 0xC0000000U);
}

TEST(SweepModel, ElevationIsWrappedToMinusHalfATurn) {
  SweepModel model = sweep_model_of_preset("paper-b");
  model.elevation_offset_rad += kPi;
  const double at_zero_rad = elevation_rad(model, model.encoder.zero_rad).value();
  EXPECT_NEAR(std::fabs(at_zero_rad), kPi, 1e-9);
  for (int i = 0; i < 1000; ++i) {
    const double elevation = elevation_rad(model, 0.01 * i).value();
    EXPECT_GE(elevation, -kPi);
    EXPECT_LT(elevation, kPi);
  }
}

TEST(SweepModel, TableGoesOnWhereTheElevationPassesHalfATurn) {
  SweepModel model = sweep_model_of_preset("paper-b");
  model.elevation_offset_rad += kPi - 0.5;
  const ElevationTable table = elevation_table(model, 10);
  const std::vector<double>& values_rad = table.values_rad();
  for (std::size_t i = 1; i < values_rad.size(); ++i) {
    ASSERT_LT(std::fabs(values_rad[i] - values_rad[i - 1]), 0.03);
    const double closed_rad = elevation_rad(model, crank_rad(model.encoder, 20000.0 * double(i) / 1024.0)).value();
    ASSERT_NEAR(std::remainder(values_rad[i] - closed_rad, kTwoPi), 0.0, 1e-12);
  }
}

// In a double crank the rocker turns fully; the table then ends a turn from where it begins.
TEST(SweepModel, TableOfARockerThatTurnsFully) {
  SweepModel model;
  model.bars = {.crank_m = 0.08, .coupler_m = 0.07, .rocker_m = 0.075, .ground_m = 0.03};
  for (const double offset_rad : {-3.0, 0.0, 3.0}) {
    model.elevation_offset_rad = offset_rad;
    const std::vector<double> values_rad = elevation_table(model, 12).values_rad();
    EXPECT_NEAR(std::fabs(values_rad.back() - values_rad.front()), kTwoPi, 1e-9);
  }
}

// The crossed assembly seen from behind is the open one.
TEST(SweepModel, MirrorImageNodsAlike) {
  const SweepModel open = sweep_model_of_preset("paper-b");
  SweepModel mirrored = open;
  mirrored.assembly = Assembly::kCrossed;
  mirrored.encoder.zero_rad = -open.encoder.zero_rad;
  mirrored.encoder.direction = -open.encoder.direction;
  mirrored.elevation_sign = -open.elevation_sign;
  const std::vector<double> open_rad = elevation_table(open, 8).values_rad();
  const std::vector<double> mirrored_rad = elevation_table(mirrored, 8).values_rad();
  for (std::size_t i = 0; i <= 256; ++i) EXPECT_NEAR(open_rad[i], mirrored_rad[i], 1e-12);
}

TEST(SweepModel, CrossedAssemblyIsSetUpToLiftSlowlyToo) {
  const SweepModel crossed = sweep_model_of(sweep_model_of_preset("paper-b").bars, Assembly::kCrossed);
  EXPECT_EQ(crossed.assembly, Assembly::kCrossed);
  const std::vector<double> values_rad = elevation_table(crossed, 12).values_rad();
  const auto [low, high] = std::minmax_element(values_rad.begin(), values_rad.end());
  EXPECT_NEAR(*low, 0.0, 1e-9);
  EXPECT_EQ(low, values_rad.begin());
  EXPECT_NEAR(*high, rad_from_deg(93.0), rad_from_deg(0.05));
  EXPECT_NEAR(static_cast<double>(high - low) / 4096.0, 266.0 / 360.0, 0.002);
}

TEST(SweepModel, ALoopThatOpensHasNoTable) {
  SweepModel model;
  model.name = "mine";
  model.bars = {.crank_m = 0.06, .coupler_m = 0.085, .rocker_m = 0.088, .ground_m = 0.12};
  EXPECT_TRUE(elevation_rad(model, 0.0).has_value());
  EXPECT_FALSE(elevation_rad(model, kPi).has_value());
  EXPECT_FALSE(elevation_rate(model, kPi).has_value());
  try {
    static_cast<void>(elevation_table(model));
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("linkage 'mine': the crank cannot turn fully"), HasSubstr("17.3")));
  }
  EXPECT_THROW(static_cast<void>(elevation_table(sweep_model_of_preset("paper-b"), 21)), ConfigError);
}

TEST(BeamTiming, HokuyoOf961Beams) {
  SweepModel model;
  model.mirror_rate_hz = 40.0;
  model.stamp_share = 0.5;
  const BeamTiming timing = beam_timing(model, 961, rad_from_deg(0.25));
  EXPECT_NEAR(timing.step_s, 0.25 / 360.0 / 40.0, 1e-18);
  EXPECT_NEAR(timing.of_beam_s(480), 0.0, 1e-15);
  EXPECT_NEAR(timing.of_beam_s(960), 240.0 / 360.0 / 40.0 / 2.0, 1e-15);
}

TEST(BeamTiming, StampOfTheFirstOrTheLastBeam) {
  SweepModel model;
  model.mirror_rate_hz = 75.0;
  model.stamp_share = 0.0;
  EXPECT_EQ(beam_timing(model, 361, rad_from_deg(0.5)).first_s, 0.0);
  model.stamp_share = 1.0;
  EXPECT_NEAR(beam_timing(model, 361, rad_from_deg(0.5)).of_beam_s(360), 0.0, 1e-15);
  EXPECT_EQ(beam_timing(model, 1, rad_from_deg(0.5)).first_s, 0.0);
  EXPECT_EQ(beam_timing(model, 0, rad_from_deg(0.5)).first_s, 0.0);
  // A laser that scans clockwise fires its beams in the same order.
  EXPECT_GT(beam_timing(model, 361, rad_from_deg(-0.5)).step_s, 0.0);
}

TEST(BeamTiming, IsThatOfAScanThatSaysIt) {
  SweepModel model;
  model.mirror_rate_hz = 75.0;
  LaserScan scan;
  scan.bearing_step_rad = rad_from_deg(0.5);
  scan.ranges_m.resize(361);
  EXPECT_EQ(beam_timing(model, scan).first_s, beam_timing(model, 361, rad_from_deg(0.5)).first_s);
  EXPECT_EQ(beam_timing(model, scan).step_s, beam_timing(model, 361, rad_from_deg(0.5)).step_s);
  scan.beam_period_s = 1e-4;
  EXPECT_NEAR(beam_timing(model, scan).of_beam_s(360), 0.036, 1e-15) << "from the stamp on";
  scan.first_beam_after_s = -0.01;
  EXPECT_NEAR(beam_timing(model, scan).of_beam_s(100), 0.0, 1e-15);
}

// A laser that turns clockwise, whose reader has turned its beams round.
TEST(BeamTiming, BeamsAreOrderedByTime) {
  LaserScan scan;
  scan.first_bearing_rad = -1.0;
  scan.bearing_step_rad = 0.5;
  scan.first_beam_after_s = 0.02;
  scan.beam_period_s = -0.005;
  scan.ranges_m = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  order_beams_by_time(scan);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{5.0F, 4.0F, 3.0F, 2.0F, 1.0F}));
  EXPECT_EQ(scan.first_bearing_rad, 1.0);
  EXPECT_EQ(scan.bearing_step_rad, -0.5);
  EXPECT_NEAR(scan.first_beam_after_s, 0.0, 1e-15);
  EXPECT_EQ(scan.beam_period_s, 0.005);
  const LaserScan once = scan;
  order_beams_by_time(scan);
  EXPECT_EQ(scan.ranges_m, once.ranges_m) << "those that are in order stay";
}

TEST(SweepModelValidate, SaysWhatIsWrong) {
  const auto faults = [](const std::function<void(SweepModel&)>& spoil) {
    SweepModel model = sweep_model_of_preset("paper-b");
    spoil(model);
    return validate(model);
  };
  constexpr double kNoAngle = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.crank_m = 3.6; }),
              ElementsAre("bars.crank = 3.6 m is longer than 1 m; did you mean 3.6 cm?"));
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.rocker_m = 125.0; }), ElementsAre(HasSubstr("did you mean 125 mm?")));
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.crank_m = 0.00036; }),
              ElementsAre("bars.crank = 0.00036 m is shorter than 1 mm; did you mean 0.036 m? check its unit"));
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.ground_m = -0.05; }), ElementsAre(HasSubstr("above zero")));
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.coupler_m = kNoAngle; }), ElementsAre(HasSubstr("bars.coupler")));
  EXPECT_THAT(faults([](SweepModel& m) { m.bars.ground_m = 0.25; }), ElementsAre(HasSubstr("25 > ")));
  EXPECT_THAT(faults([](SweepModel& m) { m.encoder.ticks_per_turn = 0; }),
              ElementsAre(HasSubstr("encoder.ticks_per_turn = 0")));
  EXPECT_THAT(faults([](SweepModel& m) { m.encoder.direction = 0; }), ElementsAre(HasSubstr("1 or -1")));
  EXPECT_THAT(faults([](SweepModel& m) { m.elevation_sign = 2; }), ElementsAre(HasSubstr("elevation.sign = 2")));
  EXPECT_THAT(faults([](SweepModel& m) { m.elevation_offset_rad = kNoAngle; }),
              ElementsAre(HasSubstr("elevation.offset")));
  EXPECT_THAT(faults([](SweepModel& m) { m.mount.lever_up_m = 5.0; }), ElementsAre(HasSubstr("mount.lever_up")));
  EXPECT_THAT(faults([](SweepModel& m) { m.mirror_rate_hz = -1.0; }), ElementsAre(HasSubstr("laser.mirror_rate")));
  EXPECT_THAT(faults([](SweepModel& m) { m.stamp_share = 1.5; }), ElementsAre(HasSubstr("laser.stamp")));
}

}  // namespace
}  // namespace gdtslam::calib
