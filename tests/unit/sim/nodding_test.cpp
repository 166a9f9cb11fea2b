// The nodding mount in motion: the crank's course in each mode, what the encoder tells, and where the beams go.
#include "gdtslam/sim/nodding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

using testing::ElementsAre;

MotionPlan standing_still(double duration_s) {
  std::vector<Waypoint> one(1);
  one[0].pause_s = duration_s;
  return {one, {}};
}

NoddingModel model_of(const char* preset = "paper-b") {
  NoddingModel model;
  model.truth = calib::sweep_model_of_preset(preset);
  return model;
}

// The elevation by complex numbers: the coupler's end is where the circles about the crank's end and the rocker's pivot
// meet, on the left of the line from one to the other.
double elevation_by_geometry(const calib::SweepModel& model, double turns) {
  const double crank = model.encoder.zero_rad + model.encoder.direction * 2.0 * M_PI * turns;
  const std::complex<double> a = std::polar(model.bars.crank_m, crank);
  const std::complex<double> to_pivot = model.bars.ground_m - a;
  const double length = std::abs(to_pivot);
  const double along =
      (length * length + model.bars.coupler_m * model.bars.coupler_m - model.bars.rocker_m * model.bars.rocker_m) /
      (2.0 * length);
  const double across = std::sqrt(model.bars.coupler_m * model.bars.coupler_m - along * along);
  const std::complex<double> b = a + to_pivot / length * std::complex<double>(along, across);
  const double psi = std::arg(b - std::complex<double>(model.bars.ground_m, 0.0));
  return std::remainder(model.elevation_sign * psi + model.elevation_offset_rad, 2.0 * M_PI);
}

TEST(NoddingCourse, ElevationIsThatOfTheLinkage) {
  for (const char* preset : {"paper-a", "paper-b", "paper-c", "paper-b-calibrated"}) {
    const NoddingModel model = model_of(preset);
    const NoddingCourse course(model, standing_still(30.0));
    for (double t = 0.0; t < 14.0; t += 0.0137) {
      EXPECT_NEAR(std::remainder(course.elevation_rad(t) - elevation_by_geometry(model.truth, 0.15 * t), 2.0 * M_PI),
                  0.0, 1e-9)
          << preset << " at " << t;
    }
  }
}

TEST(NoddingCourse, AnElevationErrorIsASmoothCurveOfTheCrankWithTheStatedRms) {
  const NoddingCourse nominal(model_of(), standing_still(30.0));
  NoddingModel model = model_of();
  model.elevation_error_rad = rad_from_deg(0.5);
  const NoddingCourse course(model, standing_still(30.0), 7);
  const NoddingCourse other(model, standing_still(30.0), 8);
  constexpr int kAngles = 1000;
  const double turn_s = 1.0 / model.crank_rate_hz;
  double sum = 0.0;
  double sq_sum = 0.0;
  for (int i = 0; i < kAngles; ++i) {
    const double t = turn_s * i / kAngles;
    const double error = course.elevation_rad(t) - nominal.elevation_rad(t);
    sum += error;
    sq_sum += error * error;
    // The same at the next turn; three harmonics change by at most 3 * sqrt(2) * RMS a radian of the crank.
    EXPECT_NEAR(course.elevation_rad(t + turn_s) - nominal.elevation_rad(t + turn_s), error, 1e-12);
    const double next = course.elevation_rad(t + 0.001 * turn_s) - nominal.elevation_rad(t + 0.001 * turn_s);
    EXPECT_LT(std::fabs(next - error), 0.001 * kTwoPi * 3.0 * std::sqrt(2.0) * model.elevation_error_rad);
    EXPECT_EQ(course.message(t)->ticks, nominal.message(t)->ticks);
  }
  EXPECT_NEAR(sum / kAngles, 0.0, 1e-12);
  EXPECT_NEAR(std::sqrt(sq_sum / kAngles), model.elevation_error_rad, 1e-9);
  EXPECT_NE(course.elevation_rad(1.0), other.elevation_rad(1.0));
  model.elevation_error_rad = 1.0;
  EXPECT_THAT(validate(model), ElementsAre("elevation_error must be 0 to 10 deg"));
}

TEST(NoddingCourse, ContinuousTurnsEvenlyAndTheCounterWraps) {
  NoddingModel model = model_of();
  model.start_turns = 0.25;
  const NoddingCourse course(model, standing_still(30.0));
  EXPECT_DOUBLE_EQ(course.crank_turns(2.0), 0.55);
  EXPECT_EQ(course.message(0.0)->ticks, 5000);
  EXPECT_EQ(course.message(1.0)->ticks, 8000);
  EXPECT_EQ(course.message(6.0)->ticks, 3000);  // 1.15 turns
  EXPECT_EQ(course.message(-2.0)->ticks, 19000);
  EXPECT_EQ(course.message(1.0001)->ticks, 8000);  // 8000.3 ticks
  EXPECT_EQ(course.message(1.0002)->ticks, 8001);  // 8000.6 ticks
  model.truth.encoder.wraps = false;
  EXPECT_EQ(NoddingCourse(model, standing_still(30.0)).message(6.0)->ticks, 23000);
}

TEST(NoddingCourse, SteppedStandsAtEveryHundredthTickFor250Scans) {
  NoddingModel model = model_of();
  model.mode = NodMode::kStepped;
  model.crank_rate_hz = 0.2;
  const NoddingCourse course(model, standing_still(2510.0));
  std::vector<int> scans_at(400, 0);
  for (int scan = 0; scan < 400 * 251; ++scan) {
    const double t = scan / 40.0 + 0.0125;
    const double turns = course.crank_turns(t);
    if (course.crank_turns(t - 0.001) != turns || course.crank_turns(t + 0.001) != turns) {
      continue;  // between two stops
    }
    const double step = turns * 200.0;
    EXPECT_NEAR(step, std::round(step), 1e-9);
    EXPECT_EQ(course.message(t)->ticks, static_cast<int>(std::round(step)) % 200 * 100);
    ++scans_at.at(static_cast<std::size_t>(std::round(step)));
  }
  for (const int scans : scans_at) {
    EXPECT_EQ(scans, 250);
  }
}

TEST(NoddingCourse, StopAndScanTurnsOnlyWhileTheRobotStands) {
  NoddingModel model = model_of();
  model.mode = NodMode::kStopAndScan;
  model.crank_rate_hz = 0.5;
  model.stop_every_m = 1.0;
  std::vector<Waypoint> path(3);
  path[1].position_m = {2.5, 0.0};
  path[2].position_m = {2.5, 1.0};
  const MotionPlan plan(with_scan_stops(model, path), {});
  const NoddingCourse course(model, plan);
  // Stops: 0, 0.83, 1.67, 2.5 m and around the corner 1 m on.
  EXPECT_EQ(plan.stands().size(), 5U);
  for (double t = 0.0; t < plan.duration_s(); t += 0.003) {
    const MotionState state = plan.state_at(t);
    if (state.speed_m_per_s != 0.0 || state.turn_rate_rad_per_s != 0.0) {
      EXPECT_EQ(course.crank_turns(t), std::round(course.crank_turns(t))) << t;
      EXPECT_NEAR(course.elevation_rad(t), 0.0, 1e-12) << t;
    }
  }
  EXPECT_EQ(course.crank_turns(plan.duration_s()), 5.0);
}

std::vector<std::int64_t> ticks_with(const EncoderFault& fault) {
  NoddingModel model = model_of();
  model.crank_rate_hz = 0.1;  // 2000 ticks a second
  model.faults.push_back(fault);
  const NoddingCourse course(model, standing_still(30.0));
  std::vector<std::int64_t> ticks;
  for (const double t : {1.0, 2.0, 3.0, 4.0, 5.0}) {
    const std::optional<Encoder> message = course.message(t);
    ticks.push_back(message ? message->ticks : -1);
  }
  return ticks;
}

TEST(NoddingCourse, FaultsTouchTheEncoderOnly) {
  EXPECT_THAT(ticks_with({EncoderFaultKind::kStop, 1.5, 3.5, 0}), ElementsAre(2000, 3000, 3000, 8000, 10000));
  EXPECT_THAT(ticks_with({EncoderFaultKind::kJump, 3.0, 3.0, 700}), ElementsAre(2000, 4000, 6700, 8700, 10700));
  EXPECT_THAT(ticks_with({EncoderFaultKind::kBackwards, 2.0, 4.0, 0}), ElementsAre(2000, 4000, 2000, 0, 2000));
  EXPECT_THAT(ticks_with({EncoderFaultKind::kMissing, 2.0, 4.0, 0}), ElementsAre(2000, -1, -1, 8000, 10000));
  NoddingModel model = model_of();
  const NoddingCourse sound(model, standing_still(30.0));
  model.faults.push_back({EncoderFaultKind::kBackwards, 2.0, 4.0, 0});
  EXPECT_EQ(NoddingCourse(model, standing_still(30.0)).elevation_rad(3.0), sound.elevation_rad(3.0));
}

}  // namespace
}  // namespace gdtslam::sim
