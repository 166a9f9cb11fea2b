// Four-bar kinematics on linkages whose answer is known without it: a parallelogram, a right angle, a flat linkage.
#include "gdtslam/calib/four_bar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kExact = 1e-12;

// A at (0, 3), the pivot at (4, 0): 5 apart. With coupler 3 and rocker 4 the angle at B is right, and B is the corner
// of the 3-4-5 triangle, on the left at (0, 3) + 3/5 (ahead 1.8 / 5 ...): worked out by hand.
TEST(FourBar, RightTriangleOnBothSides) {
  const FourBar bars{.crank_m = 3.0, .coupler_m = 3.0, .rocker_m = 4.0, .ground_m = 4.0};
  const auto open = solve(bars, Assembly::kOpen, 0.5 * kPi);
  const auto crossed = solve(bars, Assembly::kCrossed, 0.5 * kPi);
  ASSERT_TRUE(open && crossed);
  EXPECT_NEAR(open->transmission_rad, 0.5 * kPi, kExact);
  EXPECT_NEAR(crossed->transmission_rad, 0.5 * kPi, kExact);
  // Crossed: B falls on the ground at (0, 0), the mirror image of A's triangle with the pivots.
  EXPECT_NEAR(crossed->coupler_rad, -0.5 * kPi, kExact);
  EXPECT_NEAR(crossed->rocker_rad, kPi, kExact);
  // Open: B is the point (0, 0) mirrored in the line from (0, 3) to (4, 0), (72/25, 96/25).
  EXPECT_NEAR(open->coupler_rad, std::atan2(96.0 / 25.0 - 3.0, 72.0 / 25.0), kExact);
  EXPECT_NEAR(open->rocker_rad, std::atan2(96.0 / 25.0, 72.0 / 25.0 - 4.0), kExact);
}

TEST(FourBar, RockerAngleNeverIsMinusPi) {
  const FourBar bars{.crank_m = 3.0, .coupler_m = 3.0, .rocker_m = 4.0, .ground_m = 4.0};
  const FourBar flat{.crank_m = 1.0, .coupler_m = 2.0, .rocker_m = 3.0, .ground_m = 6.0};
  EXPECT_EQ(solve(flat, Assembly::kCrossed, 0.0)->rocker_rad, kPi);  // B lies at a negative zero
  for (const double crank_rad : {0.5 * kPi, -0.5 * kPi}) {
    for (const Assembly assembly : {Assembly::kOpen, Assembly::kCrossed}) {
      EXPECT_GT(solve(bars, assembly, crank_rad)->rocker_rad, -kPi);
    }
  }
}

TEST(FourBar, ClosesWhereItJustReachesAndNotBeyond) {
  // Flat at crank angle 0: crank 1, coupler 2 and rocker 3 end to end reach the ground of 6.
  const FourBar flat{.crank_m = 1.0, .coupler_m = 2.0, .rocker_m = 3.0, .ground_m = 6.0};
  EXPECT_THAT(violations(flat), IsEmpty());
  const auto pose = solve(flat, Assembly::kOpen, 0.0);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->transmission_rad, 0.0, 1e-6);
  EXPECT_NEAR(pose->rocker_rad, kPi, 1e-6);
  EXPECT_FALSE(motion(flat, Assembly::kOpen, 0.0).has_value());
  EXPECT_FALSE(sensitivity(flat, Assembly::kOpen, 0.0).has_value());
  EXPECT_FALSE(solve(flat, Assembly::kOpen, 0.001).has_value());
  EXPECT_FALSE(motion(flat, Assembly::kOpen, 0.001).has_value());
  EXPECT_FALSE(coupler_point(flat, Assembly::kOpen, 0.001, 0.0, 0.0).has_value());
}

TEST(FourBar, UndefinedWhereTheCrankCoversThePivot) {
  const FourBar bars{.crank_m = 1.0, .coupler_m = 2.0, .rocker_m = 2.0, .ground_m = 1.0};
  EXPECT_FALSE(solve(bars, Assembly::kOpen, 0.0).has_value());
  EXPECT_TRUE(solve(bars, Assembly::kOpen, 0.1).has_value());
}

TEST(FourBar, NamesTheInequalityThatIsBroken) {
  EXPECT_THAT(violations({.crank_m = 0.036, .coupler_m = 0.085, .rocker_m = 0.088, .ground_m = 0.25}),
              ElementsAre("the loop cannot close: the ground is longer than the other three together, "
                          "25 > 3.6 + 8.5 + 8.8 = 20.9 cm"));
  EXPECT_THAT(violations({.crank_m = 3.6, .coupler_m = 0.085, .rocker_m = 0.088, .ground_m = 0.05}),
              ElementsAre(HasSubstr("the crank is longer than the other three together, 360 > 8.5 + 8.8 + 5 = 22.3")));
}

struct ClassCase {
  FourBar bars;
  GrashofClass expected;
};

// The textbook's inversions of one chain 2, 4, 3.5, 5 (2 + 5 < 4 + 3.5), and chains that are not Grashof's.
TEST(FourBar, ClassesOfTheInversions) {
  const ClassCase cases[] = {
      {{2.0, 4.0, 3.5, 5.0}, GrashofClass::kCrankRocker},  {{4.0, 2.0, 5.0, 3.5}, GrashofClass::kDoubleRocker},
      {{3.5, 5.0, 2.0, 4.0}, GrashofClass::kRockerCrank},  {{4.0, 3.5, 5.0, 2.0}, GrashofClass::kDoubleCrank},
      {{2.0, 4.0, 2.9, 5.0}, GrashofClass::kTripleRocker}, {{2.0, 4.0, 3.0, 5.0}, GrashofClass::kChangePoint},
      {{1.0, 2.0, 1.0, 2.0}, GrashofClass::kChangePoint},  {{0.1, 0.1, 0.1, 0.1}, GrashofClass::kChangePoint}};
  for (const ClassCase& c : cases) {
    EXPECT_EQ(grashof_class(c.bars), c.expected) << class_name(grashof_class(c.bars));
  }
  EXPECT_STREQ(class_name(GrashofClass::kCrankRocker), "crank-rocker");
  EXPECT_DOUBLE_EQ(grashof_inequality({2.0, 4.0, 3.5, 5.0}).extremes_m, 7.0);
  EXPECT_DOUBLE_EQ(grashof_inequality({2.0, 4.0, 3.5, 5.0}).middles_m, 7.5);
}

TEST(FourBar, RangesOfTheCrank) {
  const auto whole = crank_ranges({2.0, 4.0, 3.5, 5.0});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_DOUBLE_EQ(whole[0].to_rad - whole[0].from_rad, kTwoPi);
  // Stops stretched: the triangle 5, 9, 4 + 5 has its side 9 = 4 + 5 at the crank angle acos((25 + 81 - 81) / 90).
  const auto outside = crank_ranges({5.0, 4.0, 5.0, 9.0});
  ASSERT_EQ(outside.size(), 1U);
  EXPECT_NEAR(outside[0].to_rad, std::acos(25.0 / 90.0), kExact);
  EXPECT_NEAR(outside[0].from_rad, -outside[0].to_rad, kExact);
  // Stops folded only: 6, 7, coupler 3 and rocker 10 leave 7 as the nearest A may come.
  const auto inside = crank_ranges({6.0, 3.0, 10.5, 7.0});
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_NEAR(inside[0].from_rad, std::acos((36.0 + 49.0 - 56.25) / 84.0), kExact);
  EXPECT_NEAR(inside[0].to_rad, kTwoPi - inside[0].from_rad, kExact);
  EXPECT_EQ(crank_ranges({6.0, 3.0, 7.0, 5.0}).size(), 2U);
  EXPECT_THAT(crank_ranges({1.0, 1.0, 1.0, 9.0}), IsEmpty());
}

}  // namespace
}  // namespace gdtslam::calib
