#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <optional>

#include "engine/mapping/wheels/turn_leap.hpp"

namespace gdtslam {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// A robot that goes straight on, turns by the wheels by 10 degrees a scan, and goes straight on again; its matches are
/// off the wheels by this many degrees at each scan of the turn. What the turn was told to leap by, in degrees.
std::optional<double> leap_of_turn(std::initializer_list<double> off_deg, double sigma_deg = 0.1) {
  TurnLeap turn;
  std::optional<double> told;
  MatchResult result;
  result.predicted_sigma_rad = result.odometry_sigma_rad = sigma_deg * kDegree;
  result.predicted_sigma_m = result.odometry_sigma_m = 0.005;
  const auto step = [&](double turn_deg, double off) {
    result.stamp_s += 0.5;
    result.T_odometry_step = {0.2, 0.0, turn_deg * kDegree};
    result.T_map_predicted = result.T_map_base * result.T_odometry_step;
    result.T_map_base = result.T_map_predicted;
    result.T_map_base.theta_rad += off * kDegree;
    if (const std::optional<double> leap = turn.take(result)) told = *leap / kDegree;
  };
  for (int i = 0; i < 8; ++i) step(0.0, 0.0);
  for (const double off : off_deg) step(10.0, off);
  for (int i = 0; i < 8; ++i) step(0.0, 0.0);
  return told;
}

TEST(TurnLeap, TellsMatchesThatEachTurnALittleTooFar) {
  const std::optional<double> leap = leap_of_turn({1.0, 1.0, 1.0, 1.0, 1.0});
  ASSERT_TRUE(leap);
  EXPECT_NEAR(*leap, 5.0, 1e-6);
}

TEST(TurnLeap, IgnoresOdometryThatIsLate) { EXPECT_FALSE(leap_of_turn({2.0, 2.0, 0.0, -2.0, -2.0})); }

TEST(TurnLeap, IgnoresWhatTheNoiseOfTheWheelsMayBe) {
  EXPECT_FALSE(leap_of_turn({0.3, 0.3, 0.3, 0.3, 0.3}));
  EXPECT_FALSE(leap_of_turn({1.0, 1.0, 1.0, 1.0, 1.0}, 2.0));
}

}  // namespace
}  // namespace gdtslam
