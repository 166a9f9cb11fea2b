// The positions a linkage runs through, and the crank that belongs to an elevation, against angles that were turned.
#include <gtest/gtest.h>

#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

SweepModel model_of(const FourBar& bars) {
  SweepModel model;
  model.bars = bars;
  return model;
}

constexpr FourBar kDoubleRocker{.crank_m = 0.08, .coupler_m = 0.04, .rocker_m = 0.07, .ground_m = 0.09};
constexpr FourBar kDoubleCrank{.crank_m = 0.07, .coupler_m = 0.06, .rocker_m = 0.08, .ground_m = 0.03};
constexpr FourBar kTripleRocker{.crank_m = 0.06, .coupler_m = 0.05, .rocker_m = 0.07, .ground_m = 0.12};

TEST(LinkageCycle, crank_comes_back_from_its_elevation) {
  for (const LinkagePreset& preset : linkage_presets()) {
    for (const int sign : {1, -1}) {
      SweepModel model = sweep_model_of_preset(preset.name);
      model.elevation_sign *= sign;
      const LinkageCycle cycle(model);
      for (const int direction : {1, -1}) {
        for (int i = 0; i < 200; ++i) {
          const double crank_rad = kTwoPi * (i + 0.37) / 200.0;
          const auto there = [&](double rad) { return *elevation_rad(model, rad); };
          const bool is_rising = wrap_angle(there(crank_rad + 1e-5 * direction) - there(crank_rad)) > 0.0;
          const double found_rad = cycle.crank_of(there(crank_rad), is_rising, direction);
          EXPECT_NEAR(wrap_angle(found_rad - crank_rad), 0.0, 1e-5)
              << preset.name << ", crank " << crank_rad << ", direction " << direction;
        }
      }
    }
  }
}

TEST(LinkageCycle, elevations_beyond_its_reach_give_the_nearest_end) {
  const LinkageCycle cycle(sweep_model_of_preset("paper-b"));
  const CrankRockerReport report = analyse(cycle.model().bars, cycle.model().assembly);
  for (const bool is_rising : {true, false}) {
    EXPECT_NEAR(wrap_angle(cycle.crank_of(-0.1, is_rising, 1) - report.lowest.crank_rad), 0.0, 0.01);
    EXPECT_NEAR(wrap_angle(cycle.crank_of(report.swing_rad + 0.1, is_rising, 1) - report.highest.crank_rad), 0.0, 0.01);
  }
}

TEST(LinkageCycle, lift_goes_from_dead_point_to_dead_point) {
  const LinkageCycle cycle(sweep_model_of_preset("paper-a"));
  const CrankRockerReport report = analyse(cycle.model().bars, cycle.model().assembly);
  EXPECT_TRUE(cycle.turns_fully());
  EXPECT_NEAR(wrap_angle(cycle.begin().crank_rad - report.lowest.crank_rad), 0.0, 1e-9);
  EXPECT_NEAR(wrap_angle(cycle.end().crank_rad - report.highest.crank_rad), 0.0, 1e-9);
  EXPECT_NEAR(std::fabs(cycle.lift_span_rad()), kTwoPi * report.lift_share, 1e-9);
  EXPECT_NEAR(cycle.end().elevation_rad - cycle.begin().elevation_rad, report.swing_rad, 1e-9);
  EXPECT_NEAR(cycle.highest_rad() - cycle.lowest_rad(), report.swing_rad, 1e-4);
}

TEST(LinkageCycle, a_film_turns_evenly_and_ends_where_it_began) {
  for (const SweepModel& model :
       {sweep_model_of_preset("paper-c"), model_of(kDoubleRocker), model_of(kDoubleCrank), model_of(kTripleRocker)}) {
    const LinkageCycle cycle(model);
    EXPECT_NEAR(wrap_angle(cycle.crank_at(1.0) - cycle.crank_at(0.0)), 0.0, 1e-12);
    const double step_rad = std::fabs(cycle.crank_at(0.01) - cycle.crank_at(0.0));
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(cycle.at(cycle.crank_at(0.01 * i))) << i;
      EXPECT_NEAR(std::fabs(cycle.crank_at(0.01 * (i + 1)) - cycle.crank_at(0.01 * i)), step_rad, 1e-9) << i;
    }
  }
}

TEST(LinkageCycle, stretch_of_a_double_rocker_is_where_its_loop_closes) {
  const LinkageCycle cycle(model_of(kDoubleRocker));
  EXPECT_FALSE(cycle.turns_fully());
  // A and the rocker's pivot are coupler and rocker apart at the far end, their difference at the near one.
  const auto crank_at_distance = [](double distance_m) {
    const FourBar& b = kDoubleRocker;
    return std::acos((b.crank_m * b.crank_m + b.ground_m * b.ground_m - distance_m * distance_m) /
                     (2.0 * b.crank_m * b.ground_m));
  };
  const double near_rad = crank_at_distance(kDoubleRocker.rocker_m - kDoubleRocker.coupler_m);
  const double far_rad = crank_at_distance(kDoubleRocker.rocker_m + kDoubleRocker.coupler_m);
  const double first = std::fabs(cycle.from_rad());
  const double second = std::fabs(cycle.from_rad() + cycle.span_rad());
  EXPECT_NEAR(std::min(first, second), near_rad, 1e-6);
  EXPECT_NEAR(std::max(first, second), far_rad, 1e-6);
}

TEST(LinkageCycle, a_rocker_that_turns_fully_sweeps_all_around) {
  const LinkageCycle cycle(model_of(kDoubleCrank));
  EXPECT_TRUE(cycle.turns_fully());
  EXPECT_TRUE(cycle.sweeps_all_around());
  EXPECT_FALSE(LinkageCycle(sweep_model_of_preset("paper-b")).sweeps_all_around());
}

TEST(LinkageCycle, bars_that_never_meet_are_refused) {
  const FourBar bars{.crank_m = 0.01, .coupler_m = 0.02, .rocker_m = 0.02, .ground_m = 0.09};
  EXPECT_THROW(LinkageCycle{model_of(bars)}, ConfigError);
}

}  // namespace
}  // namespace gdtslam::calib
