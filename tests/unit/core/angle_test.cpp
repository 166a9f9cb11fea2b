#include "gdtslam/core/angle.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

TEST(Angle, ConvertsDegrees) {
  EXPECT_EQ(kPi, std::numbers::pi);
  EXPECT_EQ(rad_from_deg(180.0), std::numbers::pi);
  EXPECT_EQ(deg_from_rad(std::numbers::pi), 180.0);
  EXPECT_DOUBLE_EQ(rad_from_deg(-90.0), -std::numbers::pi / 2.0);
}

TEST(Angle, WrapsToTheHalfOpenTurn) {
  EXPECT_EQ(wrap_angle(0.0), 0.0);
  EXPECT_EQ(wrap_angle(kPi), kPi) << "pi belongs to the interval";
  EXPECT_EQ(wrap_angle(-kPi), kPi) << "-pi does not";
  EXPECT_EQ(wrap_angle(3.0 * kPi), kPi);
  EXPECT_EQ(wrap_angle(-3.0 * kPi), kPi);
  EXPECT_EQ(wrap_angle(std::nextafter(-kPi, 0.0)), std::nextafter(-kPi, 0.0));
  EXPECT_NEAR(wrap_angle(std::nextafter(kPi, 4.0)), -kPi, 1e-15);
  EXPECT_EQ(wrap_angle(kTwoPi), 0.0);
  EXPECT_DOUBLE_EQ(wrap_angle(4.0), 4.0 - 2.0 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(wrap_angle(-4.0), 2.0 * std::numbers::pi - 4.0);
}

TEST(Angle, WrapsManyTurns) {
  // Whole turns as doubles differ from true ones by 4e-17 of the angle, less than the angle's own rounding.
  const long double turn = 2.0L * std::numbers::pi_v<long double>;
  for (double angle_rad = -1e6; angle_rad <= 1e6; angle_rad += 997.0) {
    const double expected = static_cast<double>(std::remainder(static_cast<long double>(angle_rad), turn));
    EXPECT_NEAR(wrap_angle(angle_rad), expected, 4e-17 * std::fabs(angle_rad) + 1e-15) << angle_rad;
  }
}

TEST(Angle, HasNoAngleForWhatIsNotFinite) {
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::infinity())));
  EXPECT_TRUE(std::isnan(wrap_angle(-std::numeric_limits<double>::infinity())));
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace gdtslam
