// Special values after IEEE 754-2019, section 9.2.1; accuracy is tested against MPFR in tests/oracle/core.
#include "engine/core/elementary.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr double kPiRounded = std::numbers::pi;

// Equal, with the sign of a zero counting.
void expect_same(double found, double expected) {
  EXPECT_EQ(found, expected);
  EXPECT_EQ(std::signbit(found), std::signbit(expected)) << found << " for " << expected;
}

TEST(SinCos, KeepsTheSignOfZeroAndTheTiny) {
  expect_same(sin_cos(0.0).sin, 0.0);
  expect_same(sin_cos(-0.0).sin, -0.0);
  expect_same(sin_cos(-0.0).cos, 1.0);
  expect_same(sin_cos(kTiny).sin, kTiny);
  expect_same(sin_cos(-kTiny).sin, -kTiny);
  expect_same(sin_cos(1e-300).sin, 1e-300);
  EXPECT_EQ(sin_cos(1e-9).cos, 1.0);
}

TEST(SinCos, HasNoValueForWhatIsNotFinite) {
  for (const double angle_rad : {kInfinity, -kInfinity, kNoNumber}) {
    EXPECT_TRUE(std::isnan(sin_cos(angle_rad).sin));
    EXPECT_TRUE(std::isnan(sin_cos(angle_rad).cos));
    EXPECT_TRUE(std::isnan(sin_cos(static_cast<float>(angle_rad)).sin));
    EXPECT_TRUE(std::isnan(sin_cos(static_cast<float>(angle_rad)).cos));
  }
}

TEST(SinCos, SinglePrecisionKeepsTheSignOfZero) {
  expect_same(static_cast<double>(sin_cos(0.0F).sin), 0.0);
  expect_same(static_cast<double>(sin_cos(-0.0F).sin), -0.0);
  EXPECT_EQ(sin_cos(0.0F).cos, 1.0F);
}

TEST(Atan2, SpecialValues) {
  expect_same(atan2(0.0, 1.0), 0.0);
  expect_same(atan2(-0.0, 1.0), -0.0);
  expect_same(atan2(0.0, -1.0), kPiRounded);
  expect_same(atan2(-0.0, -1.0), -kPiRounded);
  expect_same(atan2(0.0, 0.0), 0.0);
  expect_same(atan2(-0.0, 0.0), -0.0);
  expect_same(atan2(0.0, -0.0), kPiRounded);
  expect_same(atan2(-0.0, -0.0), -kPiRounded);
  expect_same(atan2(1.0, 0.0), kPiRounded / 2.0);
  expect_same(atan2(1.0, -0.0), kPiRounded / 2.0);
  expect_same(atan2(-1.0, 0.0), -kPiRounded / 2.0);
  expect_same(atan2(kInfinity, 1.0), kPiRounded / 2.0);
  expect_same(atan2(-kInfinity, -1.0), -kPiRounded / 2.0);
  expect_same(atan2(1.0, kInfinity), 0.0);
  expect_same(atan2(-1.0, kInfinity), -0.0);
  expect_same(atan2(1.0, -kInfinity), kPiRounded);
  expect_same(atan2(-1.0, -kInfinity), -kPiRounded);
  expect_same(atan2(0.0, -kInfinity), kPiRounded);
  expect_same(atan2(kInfinity, 0.0), kPiRounded / 2.0);
  expect_same(atan2(kInfinity, kInfinity), kPiRounded / 4.0);
  expect_same(atan2(kInfinity, -kInfinity), 3.0 * kPiRounded / 4.0);
  expect_same(atan2(-kInfinity, kInfinity), -kPiRounded / 4.0);
  expect_same(atan2(-kInfinity, -kInfinity), -3.0 * kPiRounded / 4.0);
  EXPECT_TRUE(std::isnan(atan2(kNoNumber, 1.0)));
  EXPECT_TRUE(std::isnan(atan2(1.0, kNoNumber)));
  EXPECT_TRUE(std::isnan(atan2(kNoNumber, kInfinity)));
}

TEST(Atan2, ExtremesNeitherOverflowNorVanish) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  expect_same(atan2(kLargest, kLargest), kPiRounded / 4.0);
  expect_same(atan2(kTiny, kTiny), kPiRounded / 4.0);
  expect_same(atan2(-kTiny, -kTiny), -3.0 * kPiRounded / 4.0);
  expect_same(atan2(kTiny, 1.0), kTiny);
  expect_same(atan2(kTiny, kLargest), 0.0);
  expect_same(atan2(-kTiny, kLargest), -0.0);
  expect_same(atan2(kLargest, kTiny), kPiRounded / 2.0);
  expect_same(atan2(kTiny, -kLargest), kPiRounded);
}

TEST(Exp, SpecialValues) {
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-0.0), 1.0);
  EXPECT_EQ(exp(kTiny), 1.0);
  EXPECT_EQ(exp(kInfinity), kInfinity);
  expect_same(exp(-kInfinity), 0.0);
  EXPECT_TRUE(std::isnan(exp(kNoNumber)));
}

TEST(Exp, EndsOfTheRange) {
  // ln of the largest double is 709.7827128933840, of half the smallest -745.1332191019412.
  EXPECT_TRUE(std::isfinite(exp(709.782712893384)));
  EXPECT_EQ(exp(709.7827128933841), kInfinity);
  EXPECT_EQ(exp(710.0), kInfinity);
  EXPECT_EQ(exp(1e300), kInfinity);
  EXPECT_EQ(exp(-745.13), kTiny);
  expect_same(exp(-745.14), 0.0);
  expect_same(exp(-746.0), 0.0);
  expect_same(exp(-1e300), 0.0);
}

TEST(Log, SpecialValues) {
  expect_same(log(1.0), 0.0);
  EXPECT_EQ(log(0.0), -kInfinity);
  EXPECT_EQ(log(-0.0), -kInfinity);
  EXPECT_EQ(log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(log(-kTiny)));
  EXPECT_TRUE(std::isnan(log(-kInfinity)));
  EXPECT_TRUE(std::isnan(log(kNoNumber)));
  EXPECT_EQ(log(2.0), std::numbers::ln2);
  EXPECT_EQ(log(kTiny), -744.4400719213812);
}

}  // namespace
}  // namespace gdtslam
