// What a crank-rocker does, against a brute-force scan of its turn: the coupler's joint is found by bisection on the
// circle around the crank's end, in long double with the C library's sines, not in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::calib {
namespace {

using Real = long double;
constexpr Real kLongPi = 3.14159265358979323846264338327950288L;

struct Position {
  Real rocker = 0.0L;
  Real transmission = 0.0L;
};

/// For crank-rockers. The distance from the rocker's pivot to the coupler's end grows as the coupler turns from the
/// direction of the pivot to the opposite one, on the left of it for the open mode.
Position brute_position(const FourBar& bars, Assembly assembly, Real crank) {
  const Real ax = static_cast<Real>(bars.crank_m) * std::cos(crank);
  const Real ay = static_cast<Real>(bars.crank_m) * std::sin(crank);
  const Real ground = static_cast<Real>(bars.ground_m);
  const Real coupler = static_cast<Real>(bars.coupler_m);
  const Real rocker = static_cast<Real>(bars.rocker_m);
  const Real toward = std::atan2(-ay, ground - ax);
  const Real side = assembly == Assembly::kOpen ? 1.0L : -1.0L;
  Real low = 0.0L;
  Real high = kLongPi;
  const auto end_x = [&](Real turn) { return ax + coupler * std::cos(toward + side * turn); };
  const auto end_y = [&](Real turn) { return ay + coupler * std::sin(toward + side * turn); };
  for (int i = 0; i < 62; ++i) {
    const Real middle = 0.5L * (low + high);
    (std::hypot(end_x(middle) - ground, end_y(middle)) < rocker ? low : high) = middle;
  }
  Position position;
  position.rocker = std::atan2(end_y(low), end_x(low) - ground);
  const Real between = std::fabs(std::remainder(toward + side * low - position.rocker, 2.0L * kLongPi));
  position.transmission = std::min(between, kLongPi - between);
  return position;
}

struct Scan {
  Real lowest = 1e9L;
  Real highest = -1e9L;
  Real crank_of_lowest = 0.0L;
  Real crank_of_highest = 0.0L;
  Real least_transmission = 1e9L;
  Real most_rate = 0.0L;
};

constexpr int kScanSteps = 8000;
constexpr Real kScanStep = 2.0L * kLongPi / kScanSteps;

Scan scan(const FourBar& bars, Assembly assembly) {
  Scan result;
  Real last = brute_position(bars, assembly, -kScanStep).rocker;
  for (int i = 0; i < kScanSteps; ++i) {
    const Real crank = kScanStep * i;
    const Position position = brute_position(bars, assembly, crank);
    if (position.rocker < result.lowest) {
      result.lowest = position.rocker;
      result.crank_of_lowest = crank;
    }
    if (position.rocker > result.highest) {
      result.highest = position.rocker;
      result.crank_of_highest = crank;
    }
    result.least_transmission = std::min(result.least_transmission, position.transmission);
    result.most_rate = std::max(result.most_rate, std::fabs(position.rocker - last) / kScanStep);
    last = position.rocker;
  }
  return result;
}

double angle_between(double a_rad, Real b_rad) {
  return std::fabs(static_cast<double>(std::remainder(static_cast<Real>(a_rad) - b_rad, 2.0L * kLongPi)));
}

FourBar random_crank_rocker(Random& random) {
  while (true) {
    const FourBar bars{.crank_m = random.uniform(0.01, 0.05),
                       .coupler_m = random.uniform(0.02, 0.2),
                       .rocker_m = random.uniform(0.02, 0.2),
                       .ground_m = random.uniform(0.02, 0.2)};
    const GrashofInequality sums = grashof_inequality(bars);
    if (grashof_class(bars) == GrashofClass::kCrankRocker && sums.middles_m - sums.extremes_m > 0.003) {
      return bars;
    }
  }
}

void expect_as_scanned(const FourBar& bars, Assembly assembly) {
  const Scan scanned = scan(bars, assembly);
  const CrankRockerReport report = analyse(bars, assembly);
  // Near a turning point a step of the scan changes the rocker by its square.
  EXPECT_NEAR(report.lowest.rocker_rad, static_cast<double>(scanned.lowest), 1e-5);
  EXPECT_NEAR(report.highest.rocker_rad, static_cast<double>(scanned.highest), 1e-5);
  EXPECT_NEAR(report.swing_rad, static_cast<double>(scanned.highest - scanned.lowest), 2e-5);
  const double step = 1.01 * static_cast<double>(kScanStep);
  EXPECT_LT(angle_between(report.lowest.crank_rad, scanned.crank_of_lowest), step);
  EXPECT_LT(angle_between(report.highest.crank_rad, scanned.crank_of_highest), step);
  const double counter_clockwise = static_cast<double>(scanned.crank_of_highest - scanned.crank_of_lowest) / kTwoPi;
  const double share = counter_clockwise - std::floor(counter_clockwise);
  EXPECT_NEAR(report.lift_share, std::max(share, 1.0 - share), 2e-4);
  if (std::fabs(share - 0.5) > 1e-3) {
    EXPECT_EQ(report.lift_direction, share > 0.5 ? 1 : -1);
  }
  EXPECT_NEAR(report.least_transmission_rad, static_cast<double>(scanned.least_transmission), 1e-6);
  EXPECT_NEAR(report.most_rocker_rate, static_cast<double>(scanned.most_rate), 1e-4 * report.most_rocker_rate + 1e-5);
}

TEST(CrankRockerOracle, EveryPresetIsAsAScanOfItsTurn) {
  for (const LinkagePreset& preset : linkage_presets()) {
    SCOPED_TRACE(preset.name);
    expect_as_scanned(preset.bars, Assembly::kOpen);
    expect_as_scanned(preset.bars, Assembly::kCrossed);
  }
}

TEST(CrankRockerOracle, RandomCrankRockersAreAsAScanOfTheirTurn) {
  Random random(20260612);
  for (int i = 0; i < 12; ++i) {
    const FourBar bars = random_crank_rocker(random);
    SCOPED_TRACE(testing::Message() << bars.crank_m << " " << bars.coupler_m << " " << bars.rocker_m << " "
                                    << bars.ground_m);
    expect_as_scanned(bars, i % 2 == 0 ? Assembly::kOpen : Assembly::kCrossed);
  }
}

TEST(CrankRockerOracle, PositionsAreThoseOfTheBisection) {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const FourBar bars = random_crank_rocker(random);
    const Assembly assembly = i % 2 == 0 ? Assembly::kOpen : Assembly::kCrossed;
    const double crank_rad = random.uniform(-7.0, 7.0);
    const auto pose = solve(bars, assembly, crank_rad);
    ASSERT_TRUE(pose.has_value());
    const Position expected = brute_position(bars, assembly, static_cast<Real>(crank_rad));
    EXPECT_LT(angle_between(pose->rocker_rad, expected.rocker), 1e-11);
    EXPECT_LT(std::fabs(pose->transmission_rad - static_cast<double>(expected.transmission)), 1e-10);
  }
}

// At an extreme of the rate the line through the poles of crank-rocker and coupler-ground is at a right angle to the
// coupler [Freudenstein1956]: found without differentiating.
TEST(CrankRockerOracle, TheLargestRateIsWhereFreudensteinsTheoremHasIt) {
  Random random(11);
  for (int i = 0; i < 10; ++i) {
    const FourBar bars = random_crank_rocker(random);
    const double most = analyse(bars, Assembly::kOpen).most_rocker_rate;
    double worst = 1.0;
    for (int k = 0; k < 40000; ++k) {
      const double crank_rad = kTwoPi * k / 40000;
      const LinkagePose pose = solve(bars, Assembly::kOpen, crank_rad).value();
      const double rate = std::fabs(motion(bars, Assembly::kOpen, crank_rad).value().rocker_rate);
      if (most - rate > 1e-8 * most) {
        continue;
      }
      const Point2 a(bars.crank_m * std::cos(crank_rad), bars.crank_m * std::sin(crank_rad));
      const Point2 along(std::cos(pose.coupler_rad), std::sin(pose.coupler_rad));
      const Point2 u(std::cos(crank_rad), std::sin(crank_rad));
      const Point2 v(std::cos(pose.rocker_rad), std::sin(pose.rocker_rad));
      // Crank-rocker: the coupler's line meets the ground's. Coupler-ground: the crank's line meets the rocker's.
      const Point2 relative(a.x() - along.x() * a.y() / along.y(), 0.0);
      const double reach = bars.ground_m * v.y() / (u.x() * v.y() - u.y() * v.x());
      const Point2 axis = (reach * u - relative).normalized();
      worst = std::min(worst, std::fabs(axis.dot(along)));
    }
    EXPECT_LT(worst, 2e-3);
  }
}

// Whatever crank-rocker one draws, the design for its own swing, time ratio and longest bar transmits at least as well.
TEST(DesignOracle, NoRandomLinkageBeatsTheDesign) {
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    const FourBar bars = random_crank_rocker(random);
    const CrankRockerReport report = analyse(bars, Assembly::kOpen);
    DesignGoal goal;
    goal.swing_rad = report.swing_rad;
    goal.least_crank_m = goal.most_crank_m = bars.crank_m;
    goal.longest_bar_m = std::max({bars.coupler_m, bars.rocker_m, bars.ground_m}) * (1.0 + 1e-9);
    goal.min_transmission_rad = 1e-6;
    goal.time_ratio = report.time_ratio;
    const Design same = design(goal).front();
    EXPECT_GE(same.report.least_transmission_rad, report.least_transmission_rad - 1e-6);
    EXPECT_NEAR(same.report.time_ratio, report.time_ratio, 1e-6);
    EXPECT_NEAR(same.report.swing_rad, report.swing_rad, 1e-6);
    goal.time_ratio.reset();
    EXPECT_GE(design(goal).front().report.least_transmission_rad, same.report.least_transmission_rad - 1e-6);
  }
}

}  // namespace
}  // namespace gdtslam::calib
