// Designed crank-rockers: they meet their goal, and what cannot be met is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

TEST(Design, TheBestComeFirstAndSpreadOverTheCrank) {
  const std::vector<Design> designs = design({}, 5);
  ASSERT_EQ(designs.size(), 5U);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    EXPECT_NEAR(designs[i].bars.crank_m, 0.03 + 0.005 * static_cast<double>(i), 1e-12);
    if (i > 0) {
      EXPECT_LT(designs[i].report.least_transmission_rad, designs[i - 1].report.least_transmission_rad);
    }
  }
}

TEST(Design, LeavesOutCranksThatDoNotMeetTheGoal) {
  DesignGoal goal;
  goal.longest_bar_m = 0.12;
  goal.min_transmission_rad = rad_from_deg(42.0);
  const std::vector<Design> designs = design(goal, 5);
  EXPECT_GE(designs.size(), 1U);
  EXPECT_LT(designs.size(), 5U);
}

TEST(Design, IsDeterministic) {
  const Design first = design({}).front();
  const Design second = design({}).front();
  EXPECT_EQ(first.bars.coupler_m, second.bars.coupler_m);
  EXPECT_EQ(first.bars.ground_m, second.bars.ground_m);
}

TEST(Design, SaysThatTheSwingIsTooLarge) {
  DesignGoal goal;
  goal.swing_rad = rad_from_deg(120.0);
  EXPECT_THAT(message_of(goal), AllOf(HasSubstr("a swing of 120.0 deg"), HasSubstr("below 30.0 deg"),
                                      HasSubstr("40.0 deg are asked for")));
}

TEST(Design, SaysThatTheTimeRatioIsTooHighAndWhatIsReached) {
  DesignGoal goal;
  goal.time_ratio = 1.2;
  EXPECT_THAT(message_of(goal), AllOf(HasSubstr("the best reaches 30.0 deg"), HasSubstr("the time ratio is too high")));
}

TEST(Design, SaysThatTheBarsAreTooShortAndHowLongWouldDo) {
  DesignGoal goal;
  goal.min_transmission_rad = rad_from_deg(44.0);
  goal.least_crank_m = 0.05;
  const std::string message = message_of(goal);
  EXPECT_THAT(message, AllOf(HasSubstr("the best reaches 43.1 deg"), HasSubstr("allow a longest bar of ")));
  const std::size_t at = message.find("longest bar of ") + 15;
  goal.longest_bar_m = std::stod(message.substr(at)) / 100.0 * 1.01;
  EXPECT_EQ(message_of(goal), "no error");
  goal.longest_bar_m = *goal.longest_bar_m * 0.97;
  EXPECT_NE(message_of(goal), "no error");
}

TEST(Design, SaysThatNothingFits) {
  DesignGoal goal;  // the rocker of a swing of 10 deg is at least 11.5 cranks long
  goal.swing_rad = rad_from_deg(10.0);
  EXPECT_THAT(message_of(goal), AllOf(HasSubstr("exists"), HasSubstr("the bars are too short")));
}

TEST(Design, RefusesNumbersThatAreNoGoal) {
  const auto with = [](auto change) {
    DesignGoal goal;
    change(goal);
    return message_of(goal);
  };
  const double nan = std::nan("");
  EXPECT_THAT(with([](DesignGoal& g) { g.swing_rad = 90.0; }), HasSubstr("swing"));
  EXPECT_THAT(with([nan](DesignGoal& g) { g.swing_rad = nan; }), HasSubstr("swing"));
  EXPECT_THAT(with([](DesignGoal& g) { g.min_transmission_rad = 2.0; }), HasSubstr("transmission"));
  EXPECT_THAT(with([](DesignGoal& g) { g.time_ratio = 0.9; }), HasSubstr("time ratio"));
  EXPECT_THAT(with([nan](DesignGoal& g) { g.time_ratio = nan; }), HasSubstr("time ratio"));
  EXPECT_THAT(with([](DesignGoal& g) { g.least_crank_m = 0.06; }), HasSubstr("crank's range"));
  EXPECT_THAT(with([nan](DesignGoal& g) { g.most_crank_m = nan; }), HasSubstr("crank's range"));
  EXPECT_THAT(with([](DesignGoal& g) { g.longest_bar_m = 0.02; }), HasSubstr("longest bar"));
}

}  // namespace
}  // namespace gdtslam::calib
