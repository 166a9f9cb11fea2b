// The sweep model against geometry done anew here, with the C library's functions: the rocker as the intersection of
// two circles, the paper's motion, the table's accuracy, the quantisation bound by trying many points.
#include "gdtslam/calib/sweep_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::calib {
namespace {

// The coupler joint is where the circles of the coupler about A and of the rocker about its pivot meet, left of the
// line from A to the pivot.
double rocker_rad(const FourBar& bars, double crank_rad) {
  const double ax = bars.crank_m * std::cos(crank_rad);
  const double ay = bars.crank_m * std::sin(crank_rad);
  const double dx = bars.ground_m - ax;
  const double distance = std::hypot(dx, ay);
  const double along =
      (distance * distance + bars.coupler_m * bars.coupler_m - bars.rocker_m * bars.rocker_m) / (2.0 * distance);
  const double left = std::sqrt(bars.coupler_m * bars.coupler_m - along * along);
  const double ux = dx / distance;
  const double uy = -ay / distance;
  const double bx = ax + along * ux - left * uy;
  const double by = ay + along * uy + left * ux;
  return std::atan2(by, bx - bars.ground_m);
}

double crank_at(const SweepModel& model, double turns) {
  return model.encoder.zero_rad + model.encoder.direction * 2.0 * kPi * turns;
}

double elevation_at(const SweepModel& model, double turns) {
  return model.elevation_sign * rocker_rad(model.bars, crank_at(model, turns)) + model.elevation_offset_rad;
}

double apart_rad(double a_rad, double b_rad) { return std::fabs(std::remainder(a_rad - b_rad, 2.0 * kPi)); }

class SweepModelOracle : public testing::TestWithParam<std::string> {
 protected:
  SweepModel model_ = sweep_model_of_preset(GetParam());
};

TEST_P(SweepModelOracle, ElevationIsTheRockersAngle) {
  for (int i = 0; i < 10'000; ++i) {
    const double turns = i / 10'000.0;
    ASSERT_LT(apart_rad(elevation_rad(model_, crank_at(model_, turns)).value(), elevation_at(model_, turns)), 1e-12);
  }
}

TEST_P(SweepModelOracle, LiftsFromElevationZeroInTheSlowStroke) {
  constexpr int kSteps = 200'000;
  double lowest_rad = 10.0;
  double highest_rad = -10.0;
  int lifting = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double here_rad = std::remainder(elevation_at(model_, i / double{kSteps}), 2.0 * kPi);
    const double next_rad = std::remainder(elevation_at(model_, (i + 1) / double{kSteps}), 2.0 * kPi);
    lowest_rad = std::min(lowest_rad, here_rad);
    highest_rad = std::max(highest_rad, here_rad);
    lifting += next_rad > here_rad ? 1 : 0;
  }
  EXPECT_NEAR(lowest_rad, 0.0, 1e-9);
  EXPECT_NEAR(elevation_at(model_, 0.0), 0.0, 1e-9);
  EXPECT_GT(lifting, kSteps / 2);
  // The table of presets in docs/linkage.md: rocker swing and time ratio, to the digits printed.
  struct Published {
    std::string name;
    double swing_deg;
    double time_ratio;
  };
  for (const Published& published : std::vector<Published>{{"paper-a", 49.0, 1.10},
                                                           {"paper-a-calibrated", 47.2, 1.03},
                                                           {"paper-b", 93.0, 2.85},
                                                           {"paper-b-calibrated", 89.7, 2.53},
                                                           {"paper-c", 93.0, 1.07},
                                                           {"paper-c-calibrated", 89.7, 1.14}}) {
    if (published.name != GetParam()) continue;
    EXPECT_NEAR(highest_rad * 180.0 / kPi, published.swing_deg, 0.051);
    EXPECT_NEAR(lifting / double(kSteps - lifting), published.time_ratio, 0.0101);
  }
}

TEST_P(SweepModelOracle, RateIsTheSlope) {
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 500; ++i) {
    const double turns = (i + 0.5) / 500.0;
    const double crank = crank_at(model_, turns);
    const double slope = (rocker_rad(model_.bars, crank + kStep) - rocker_rad(model_.bars, crank - kStep)) /
                         (2.0 * kStep) * model_.elevation_sign;
    ASSERT_NEAR(elevation_rate(model_, crank).value(), slope, 1e-7 + 1e-6 * std::fabs(slope));
  }
}

TEST_P(SweepModelOracle, TableIsWithinATenMillionthOfTheClosedForm) {
  const ElevationTable table = elevation_table(model_);
  ASSERT_EQ(table.bits(), 15U);
  double worst_rad = 0.0;
  for (int i = 0; i < 400'000; ++i) {
    const double turns = (i + 0.377) / 400'000.0;
    worst_rad = std::max(worst_rad, apart_rad(table.elevation_rad(phase_of_turns(turns)), elevation_at(model_, turns)));
  }
  EXPECT_LT(worst_rad, 1e-7);
  RecordProperty("worst_nrad", static_cast<int>(worst_rad * 1e9));
}

// The true point, and the one from a cut tick, a cut range and the table in float32.
TEST_P(SweepModelOracle, QuantisationBoundHoldsAndIsTight) {
  constexpr double kResolution_m = 0.001;
  SweepModel model = model_;
  model.mount.lever_forward_m = 0.03;
  model.mount.lever_up_m = 0.05;
  const ElevationTable table = elevation_table(model);
  Random random(7);
  for (const double most_m : {3.0, 20.0}) {
    const double bound_m = quantisation_bound_m(model, most_m, kResolution_m);
    double worst_m = 0.0;
    for (int i = 0; i < 60'000; ++i) {
      const double turns = random.uniform();
      const double ticks = std::floor(turns * static_cast<double>(model.encoder.ticks_per_turn));
      const double cut_rad = table.elevation_rad(phase_of_ticks(model.encoder, ticks));
      const double cut_m = std::floor(most_m / kResolution_m * random.uniform()) * kResolution_m;
      const double range_m = std::min(cut_m + kResolution_m * random.uniform(), most_m);
      const double bearing_rad = 0.5 * (random.uniform() - 0.5);
      const Point3 along(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
      const Point3 truth = T_level_laser(model.mount, elevation_at(model, turns)) * Point3(range_m * along);
      const Point3 found =
          T_level_laser(model.mount, static_cast<double>(static_cast<float>(cut_rad))) * Point3(cut_m * along);
      worst_m = std::max(worst_m, (truth - found).norm());
    }
    EXPECT_LE(worst_m, bound_m);
    EXPECT_GE(worst_m, 0.5 * bound_m);
  }
}

// With ticks and ranges as fine as can be, what is left of the bound is the table's own error.
TEST_P(SweepModelOracle, TheBoundOfTheTableHoldsAndIsTight) {
  SweepModel model = model_;
  model.mount = {};
  model.encoder.ticks_per_turn = std::int64_t{1} << 50;
  const ElevationTable table = elevation_table(model);
  double worst_rad = 0.0;
  for (int i = 0; i < 400'000; ++i) {
    const double turns = (i + 0.377) / 400'000.0;
    const double found = static_cast<float>(table.elevation_rad(phase_of_turns(turns)));
    worst_rad = std::max(worst_rad, apart_rad(found, elevation_at(model, turns)));
  }
  const double bound_rad = quantisation_bound_m(model, 1.0, 0.0);
  EXPECT_LE(worst_rad, bound_rad);
  EXPECT_GE(worst_rad, 0.5 * bound_rad);
}

INSTANTIATE_TEST_SUITE_P(Presets, SweepModelOracle,
                         testing::Values("paper-a", "paper-a-calibrated", "paper-b", "paper-b-calibrated", "paper-c",
                                         "paper-c-calibrated"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// docs/linkage.md, preset paper-b: lifting takes 266 deg of the turn, and the beam is beyond 90 deg for 14.6 % of it.
TEST(SweepModelOracle, ReadingBIsSlowUpAndQuickBack) {
  const SweepModel model = sweep_model_of_preset("paper-b");
  constexpr int kSteps = 100'000;
  int lifting = 0;
  int beyond = 0;
  for (int i = 0; i < kSteps; ++i) {
    lifting += elevation_at(model, (i + 1) / double{kSteps}) > elevation_at(model, i / double{kSteps}) ? 1 : 0;
    beyond += elevation_at(model, i / double{kSteps}) > kPi / 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(lifting * 360.0 / kSteps, 266.0, 0.5);
  EXPECT_NEAR(beyond * 100.0 / kSteps, 14.6, 0.06);
}

}  // namespace
}  // namespace gdtslam::calib
