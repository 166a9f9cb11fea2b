// Designed crank-rockers: they meet their goal, and what cannot be met is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::calib {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string message_of(const DesignGoal& goal) {
  try {
    design(goal);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Design, MeetsItsGoal) {
  DesignGoal goal;
  goal.swing_rad = rad_from_deg(75.0);
  goal.min_transmission_rad = rad_from_deg(30.0);
  goal.time_ratio = 1.15;
  const std::vector<Design> designs = design(goal, 3);
  ASSERT_EQ(designs.size(), 3U);
  for (const Design& found : designs) {
    EXPECT_NEAR(found.report.swing_rad, goal.swing_rad, 1e-9);
    EXPECT_NEAR(found.report.time_ratio, 1.15, 1e-9);
    EXPECT_GE(found.report.least_transmission_rad, goal.min_transmission_rad);
    EXPECT_GE(found.bars.crank_m, goal.least_crank_m);
    EXPECT_LE(found.bars.crank_m, goal.most_crank_m);
    EXPECT_LE(std::max({found.bars.coupler_m, found.bars.rocker_m, found.bars.ground_m}), 4.0 * goal.most_crank_m);
  }
}

// With equal strokes sin(swing / 2) = crank / rocker and cos(transmission) = crank ground / (coupler rocker)
// [Norton2012], so the longest ground that is allowed gives the best.
TEST(Design, CentricOneIsTheClosedForm) {
  DesignGoal goal;
  goal.time_ratio = 1.0;
  goal.longest_bar_m = 0.15;
  const Design found = design(goal).front();
  const double rocker_m = 0.03 / std::sin(0.25 * kPi);
  const double coupler_m = std::sqrt(0.15 * 0.15 + 0.03 * 0.03 - rocker_m * rocker_m);
  EXPECT_NEAR(found.bars.rocker_m, rocker_m, 1e-9);
  EXPECT_NEAR(found.bars.coupler_m, coupler_m, 1e-9);
  EXPECT_NEAR(found.bars.ground_m, 0.15, 1e-9);
  EXPECT_NEAR(found.report.least_transmission_rad, std::acos(0.03 * 0.15 / (coupler_m * rocker_m)), 1e-9);
}

// What a linkage is but for its size.
std::array<double, 4> shape_of(const FourBar& bars) {
  const double sum = bars.crank_m + bars.coupler_m + bars.rocker_m + bars.ground_m;
  return {bars.crank_m / sum, bars.coupler_m / sum, bars.rocker_m / sum, bars.ground_m / sum};
}

double apart(const FourBar& a, const FourBar& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += std::pow(shape_of(a)[k] - shape_of(b)[k], 2.0);
  return std::sqrt(sum);
}

double longest_of(const FourBar& bars) { return std::max({bars.coupler_m, bars.rocker_m, bars.ground_m}); }

TEST(Design, ManyDifferInShapeAndTheBestComesFirst) {
  const DesignGoal goal;
  const std::vector<Design> designs = design(goal, 5);
  ASSERT_EQ(designs.size(), 5U);
  EXPECT_EQ(designs.front().bars.ground_m, design(goal).front().bars.ground_m);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const Design& one = designs[i];
    EXPECT_NEAR(one.report.swing_rad, goal.swing_rad, 1e-9);
    EXPECT_GE(one.report.least_transmission_rad, goal.min_transmission_rad - 1e-9);
    if (i == 0) continue;
    EXPECT_LE(one.report.least_transmission_rad, designs[i - 1].report.least_transmission_rad + 1e-9);
    // As large as it may be: the crank is the longest, or another bar is.
    EXPECT_TRUE(std::fabs(one.bars.crank_m - goal.most_crank_m) < 1e-12 ||
                std::fabs(longest_of(one.bars) - 4.0 * goal.most_crank_m) < 1e-12);
    for (std::size_t k = 0; k < i; ++k) EXPECT_GT(apart(one.bars, designs[k].bars), 0.005) << i << " and " << k;
  }
}

TEST(Design, GivesFewerWhereTheGoalLeavesNoMoreShapes) {
  DesignGoal goal;
  goal.longest_bar_m = 0.12;
  goal.min_transmission_rad = rad_from_deg(43.0);  // the best reaches 43.1 deg
  const std::vector<Design> designs = design(goal, 20);
  EXPECT_GE(designs.size(), 1U);
  EXPECT_LT(designs.size(), 20U);
}

TEST(Design, SaysThatNothingFits) {
  DesignGoal goal;  // the rocker of a swing of 10 deg is at least 11.5 cranks long
  goal.swing_rad = rad_from_deg(10.0);
  EXPECT_THAT(message_of(goal),
              AllOf(HasSubstr("exists"), HasSubstr("the bars are too short"), Not(HasSubstr("a time ratio of"))));
}

// The reader of linkages takes bars of 1 mm to 1 m, so no other are designed.
TEST(Design, BarsAreThoseThatAreRead) {
  const auto with_crank = [](double least_m, double most_m, std::optional<double> longest_m) {
    DesignGoal goal;
    goal.least_crank_m = least_m;
    goal.most_crank_m = most_m;
    goal.longest_bar_m = longest_m;
    return goal;
  };
  for (const DesignGoal& goal : {with_crank(0.001, 0.001, {}), with_crank(0.2, 0.3, {}), with_crank(0.26, 1.0, 1.0)}) {
    for (const Design& found : design(goal, 5)) {
      for (const double bar_m : {found.bars.crank_m, found.bars.coupler_m, found.bars.rocker_m, found.bars.ground_m}) {
        EXPECT_GE(bar_m, 0.001);
        EXPECT_LE(bar_m, 1.0);
      }
    }
  }
  EXPECT_THAT(message_of(with_crank(1e-6, 1e-6, {})), HasSubstr("a crank of 0.001 mm is shorter than 1 mm"));
  EXPECT_THAT(message_of(with_crank(0.5, 1.1, {})), HasSubstr("a crank of 110 cm is longer than 1 m"));
  EXPECT_THAT(message_of(with_crank(0.03, 0.05, 1.2)), HasSubstr("a longest bar of 120 cm is longer than 1 m"));
}

}  // namespace
}  // namespace gdtslam::calib
