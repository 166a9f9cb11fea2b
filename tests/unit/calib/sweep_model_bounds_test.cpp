// The bounds of a sweep model, at them and beside them, and the bound of the quantisation by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> faults_of_values(const std::function<double&(SweepModel&)>& value, double is) {
  SweepModel model = sweep_model_of_preset("paper-b");
  value(model) = is;
  return validate(model);
}

TEST(SweepModelBounds, ValuesReachTheirBounds) {
  struct Row {
    const char* name;
    std::function<double&(SweepModel&)> value;
    double least, most;
  };
  const std::vector<Row> rows{
      {"encoder.zero", [](SweepModel& m) -> double& { return m.encoder.zero_rad; }, -kTwoPi, kTwoPi},
      {"elevation.offset", [](SweepModel& m) -> double& { return m.elevation_offset_rad; }, -2 * kTwoPi, 2 * kTwoPi},
      {"mount.height", [](SweepModel& m) -> double& { return m.mount.height_m; }, -10.0, 100.0},
      {"mount.lever_forward", [](SweepModel& m) -> double& { return m.mount.lever_forward_m; }, -1.0, 1.0},
      {"mount.lever_up", [](SweepModel& m) -> double& { return m.mount.lever_up_m; }, -1.0, 1.0},
      {"mount.roll", [](SweepModel& m) -> double& { return m.mount.sensor_roll_rad; }, -kTwoPi, kTwoPi},
      {"mount.yaw", [](SweepModel& m) -> double& { return m.mount.sensor_yaw_rad; }, -kTwoPi, kTwoPi},
      {"laser.mirror_rate", [](SweepModel& m) -> double& { return m.mirror_rate_hz; }, 0.0, 1000.0},
      {"laser.stamp", [](SweepModel& m) -> double& { return m.stamp_share; }, 0.0, 1.0}};
  for (const Row& row : rows) {
    for (const double good : {row.least, row.most})
      EXPECT_THAT(faults_of_values(row.value, good), IsEmpty()) << row.name;
    for (const double bad : {row.least - 1e-6, row.most + 1e-6}) {
      EXPECT_THAT(faults_of_values(row.value, bad), ElementsAre(HasSubstr(std::string(row.name) + " = "))) << bad;
    }
  }
}

TEST(SweepModelBounds, TicksReachABillion) {
  for (const std::int64_t ticks : {std::int64_t{1}, std::int64_t{1} << 30}) {
    SweepModel model = sweep_model_of_preset("paper-b");
    model.encoder.ticks_per_turn = ticks;
    EXPECT_THAT(validate(model), IsEmpty()) << ticks;
  }
  for (const std::int64_t ticks : {std::int64_t{-1}, std::int64_t{0}, (std::int64_t{1} << 30) + 1}) {
    SweepModel model = sweep_model_of_preset("paper-b");
    model.encoder.ticks_per_turn = ticks;
    EXPECT_THAT(validate(model), ElementsAre(HasSubstr("must be 1 to 1073741824"))) << ticks;
  }
}

TEST(SweepModelBounds, SignsAreOneOrMinusOne) {
  for (const int sign : {-2, -1, 0, 1, 2}) {
    SweepModel model = sweep_model_of_preset("paper-b");
    model.elevation_sign = model.encoder.direction = sign;
    EXPECT_EQ(validate(model).size(), sign == 1 || sign == -1 ? 0U : 2U) << sign;
  }
}

TEST(SweepModelBounds, BarsAreAMillimetreToAMetre) {
  const auto faults = [](double crank_m, double others_m) {
    SweepModel model = sweep_model_of_preset("paper-b");
    model.bars = {.crank_m = crank_m, .coupler_m = others_m, .rocker_m = others_m, .ground_m = others_m};
    return validate(model);
  };
  EXPECT_THAT(faults(0.001, 1.0), IsEmpty());
  EXPECT_THAT(faults(0.0009999, 1.0), ElementsAre(HasSubstr("did you mean 0.09999 m? check its unit")));
  EXPECT_THAT(faults(0.5, 1.0001).size(), 3U);
  EXPECT_THAT(faults(100.0, 1.0), ElementsAre(HasSubstr("did you mean 100 cm?")));
  EXPECT_THAT(faults(101.0, 1.0), ElementsAre(HasSubstr("did you mean 101 mm?")));
  EXPECT_THAT(faults(0.00001, 1.0), ElementsAre(HasSubstr("did you mean 0.001 m?"))) << "a centimetre as metres";
  EXPECT_THAT(faults(0.0000099, 1.0), ElementsAre("bars.crank = 9.9e-06 m is shorter than 1 mm; check its unit"));
}

// The lever is the diagonal of its two parts, and what a tick moves grows with range and lever together.
TEST(SweepModelBounds, QuantisationGrowsWithTheLever) {
  SweepModel model = sweep_model_of_preset("paper-b");
  const double at_two_m = quantisation_bound_m(model, 2.0, 0.0);
  const double at_seven_m = quantisation_bound_m(model, 7.0, 0.0);
  model.mount.lever_forward_m = 0.3;
  model.mount.lever_up_m = -0.4;
  EXPECT_NEAR(quantisation_bound_m(model, 2.0, 0.0), at_two_m + 0.1 * (at_seven_m - at_two_m), 1e-12);
  EXPECT_NEAR(quantisation_bound_m(model, 2.0, 0.05) - quantisation_bound_m(model, 2.0, 0.0), 0.05, 1e-12);
}

// Of so many ticks that one is next to nothing, the table is left: it lies within the bound, but not far from it.
TEST(SweepModelBounds, TheTablesOwnErrorIsBounded) {
  SweepModel model = sweep_model_of_preset("paper-b");
  model.encoder.ticks_per_turn = std::int64_t{1} << 30;
  const double steps = 32768.0;
  double steepest_rad = 0.0;
  double most_bent_rad = 0.0;
  double highest_rad = 0.0;
  const auto elevation = [&](double step) {
    return *elevation_rad(model, model.encoder.zero_rad + model.encoder.direction * kTwoPi * step / steps);
  };
  for (double step = 0.0; step < steps; step += 1.0) {
    const double before = elevation(step - 1.0);
    const double here = elevation(step);
    const double after = elevation(step + 1.0);
    steepest_rad = std::max(steepest_rad, std::fabs(after - here));
    most_bent_rad = std::max(most_bent_rad, std::fabs(after - 2.0 * here + before));
    highest_rad = std::max(highest_rad, std::fabs(here));
  }
  const double by_tick = steepest_rad * steps / static_cast<double>(model.encoder.ticks_per_turn);
  const double by_table = 1.02 * most_bent_rad / 8.0 + std::ldexp(highest_rad, -24);
  EXPECT_NEAR(quantisation_bound_m(model, 1.0, 0.0), by_tick + by_table, 1e-11);
}

TEST(SweepModelBounds, ATableHasAtMostAMillionSteps) {
  const SweepModel model = sweep_model_of_preset("paper-b");
  EXPECT_EQ(elevation_table(model, 0).values_rad().size(), 2U);
  EXPECT_EQ(elevation_table(model, 15).values_rad().size(), 32769U);
  EXPECT_EQ(elevation_table(model, 20).values_rad().size(), (std::size_t{1} << 20) + 1);
}

TEST(SweepModelBounds, RateIsThatOfDifferencesOnEitherSign) {
  for (const int sign : {1, -1}) {
    SweepModel model = sweep_model_of_preset("paper-b");
    model.elevation_sign = sign;
    for (const double crank_rad : {0.3, 2.0, 4.5}) {
      const double step_rad = 1e-6;
      const double difference =
          wrap_angle(*elevation_rad(model, crank_rad + step_rad) - *elevation_rad(model, crank_rad - step_rad));
      EXPECT_NEAR(*elevation_rate(model, crank_rad), difference / (2.0 * step_rad), 1e-6);
    }
  }
}

}  // namespace
}  // namespace gdtslam::calib
