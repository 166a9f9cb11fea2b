// The positions a linkage runs through against the law of cosines, the ends of its lift against its dead points, and
// the crank that belongs to an elevation against angles that were turned.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "support/linkage_joints.hpp"

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

/// The presets and a crossed linkage, each with an elevation that rises with the rocker's angle and with one that
/// falls.
std::vector<SweepModel> models_of_both_signs() {
  std::vector<SweepModel> models;
  for (const LinkagePreset& preset : linkage_presets()) models.push_back(sweep_model_of_preset(preset.name));
  models.push_back(
      sweep_model_of({.crank_m = 0.04, .coupler_m = 0.1, .rocker_m = 0.09, .ground_m = 0.11}, Assembly::kCrossed));
  const std::size_t count = models.size();
  for (std::size_t i = 0; i < count; ++i) {
    SweepModel model = models[i];
    model.name += ", the other sign";
    model.elevation_sign = -model.elevation_sign;
    model.elevation_offset_rad += 0.4;
    models.push_back(model);
  }
  return models;
}

void expect_joints(const SweepModel& model, const LinkagePosition& position) {
  const auto expected = test::expected_joints(model, position.crank_rad);
  ASSERT_TRUE(expected) << model.name << ", crank " << position.crank_rad;
  for (std::size_t joint = 0; joint < 4; ++joint) {
    EXPECT_LT((position.joints[joint] - (*expected)[joint]).norm(), 1e-12)
        << model.name << ", joint " << joint << ", crank " << position.crank_rad;
  }
  EXPECT_LT((position.middle - 0.5 * ((*expected)[1] + (*expected)[2])).norm(), 1e-12) << model.name;
  const Point2 rocker = (*expected)[2];
  EXPECT_NEAR(wrap_angle(position.elevation_rad - std::atan2(rocker.y(), rocker.x())), 0.0, 1e-11) << model.name;
}

TEST(LinkagePosition, joints_are_where_the_law_of_cosines_puts_them) {
  for (const SweepModel& model : models_of_both_signs()) {
    for (int i = 0; i < 36; ++i) {
      const double crank_rad = 0.17 + kTwoPi * i / 36.0;
      const std::optional<LinkagePosition> position = position_at(model, crank_rad);
      ASSERT_TRUE(position) << model.name << ", crank " << crank_rad;
      EXPECT_EQ(position->crank_rad, crank_rad);
      expect_joints(model, *position);
    }
  }
}

/// At a dead point crank and coupler are in line: from the crank's pivot the coupler's end is as far as both together
/// at one end of the lift, and as their difference at the other.
TEST(LinkageCycle, lift_ends_with_crank_and_coupler_in_line) {
  for (const SweepModel& model : models_of_both_signs()) {
    const LinkageCycle cycle(model);
    const FourBar& bars = model.bars;
    const auto reach = [](const LinkagePosition& at) { return (at.joints[2] - at.joints[0]).norm(); };
    const double stretched_m = std::max(reach(cycle.begin()), reach(cycle.end()));
    const double folded_m = std::min(reach(cycle.begin()), reach(cycle.end()));
    EXPECT_NEAR(stretched_m, bars.coupler_m + bars.crank_m, 1e-12) << model.name;
    EXPECT_NEAR(folded_m, bars.coupler_m - bars.crank_m, 1e-12) << model.name;
    EXPECT_GT(cycle.end().elevation_rad, cycle.begin().elevation_rad) << model.name;
    expect_joints(model, cycle.begin());
    expect_joints(model, cycle.end());
  }
}

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

TEST(LinkageCycle, bars_that_never_meet_are_refused) {
  const FourBar bars{.crank_m = 0.01, .coupler_m = 0.02, .rocker_m = 0.02, .ground_m = 0.09};
  EXPECT_THROW(LinkageCycle{model_of(bars)}, ConfigError);
}

/// Of the lift's middle three fifths the position that transmits best; found here among ten times as many.
TEST(LinkageCycle, what_is_shown_transmits_best_in_the_middle_of_the_lift) {
  for (const SweepModel& model : models_of_both_signs()) {
    const LinkageCycle cycle(model);
    double best_rad = 0.0;
    for (int i = 1440; i <= 5760; ++i) {
      const double crank_rad = cycle.from_rad() + cycle.lift_span_rad() * i / 7200.0;
      best_rad = std::max(best_rad, solve(model.bars, model.assembly, crank_rad)->transmission_rad);
    }
    const double shown_rad = cycle.shown_crank_rad();
    const double share = (shown_rad - cycle.from_rad()) / cycle.lift_span_rad();
    EXPECT_GE(share, 0.2) << model.name;
    EXPECT_LE(share, 0.8) << model.name;
    EXPECT_NEAR(solve(model.bars, model.assembly, shown_rad)->transmission_rad, best_rad, 0.01) << model.name;
  }
}

}  // namespace
}  // namespace gdtslam::calib
