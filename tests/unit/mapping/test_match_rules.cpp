// Where a robot can be, and how far a search for it goes.
#include <gtest/gtest.h>

#include <optional>

#include "engine/mapping/match/match_rules.hpp"

namespace gdtslam {
namespace {

constexpr Pose2 kPredicted{4.0, 2.0, 0.3};

CellPose away(const MatchRules& rules, const MapperConfig& config, double x_m, double rad) {
  const auto cells = static_cast<float>(x_m / config.map.resolution_m);
  const CellPose& here = rules.predicted();
  return {here.x + cells, here.y, here.theta + static_cast<float>(rad)};
}

TEST(MatchRules, APoseIsPossibleNearEitherOfTheTwoThatAreExpected) {
  const MapperConfig config;
  MatchRules rules(config);
  const UncertainPose otherwise{kPredicted * Pose2{0.0, 0.0, 1.0}, {0.05, 0.05}};
  rules.begin({.T_map_base = kPredicted, .noise = MotionNoise{0.1, 0.02}, .otherwise = otherwise}, 100);
  EXPECT_TRUE(rules.is_possible(away(rules, config, 0.3, 0.0)));
  EXPECT_FALSE(rules.is_possible(away(rules, config, 0.7, 0.0))) << "seven standard deviations";
  EXPECT_TRUE(rules.is_possible(away(rules, config, 0.0, 1.0))) << "as the other";
  EXPECT_FALSE(rules.is_possible(away(rules, config, 0.0, 0.5))) << "as neither";
  EXPECT_FALSE(rules.is_possible(away(rules, config, 0.3, 1.0)));
}

TEST(MatchRules, WithoutAnEstimateEveryPoseIsPossible) {
  const MapperConfig config;
  MatchRules rules(config);
  rules.begin({.T_map_base = kPredicted}, 100);
  EXPECT_TRUE(rules.is_possible(away(rules, config, 20.0, 3.0)));
}

TEST(MatchRules, AWindowGrowsNoFartherThanTheRobotCanBe) {
  const MapperConfig config;
  MatchRules rules(config);
  const double step = config.map.resolution_m;
  rules.begin({.T_map_base = kPredicted, .noise = MotionNoise{0.2, 0.05}, .otherwise = std::nullopt}, 100);
  const double first_m = static_cast<double>(rules.window(1.0).half_xy_cells) * step;
  const double most_m = static_cast<double>(rules.window(64.0).half_xy_cells) * step;
  EXPECT_GT(first_m, 4.0 * 0.2);
  EXPECT_GE(most_m, first_m);
  EXPECT_LT(most_m, 6.0 * 0.21);
  const UncertainPose otherwise{kPredicted * Pose2{1.0, 0.0, 0.0}, {0.2, 0.2}};
  rules.begin({.T_map_base = kPredicted, .noise = MotionNoise{0.2, 0.05}, .otherwise = otherwise}, 100);
  EXPECT_GT(static_cast<double>(rules.window(64.0).half_xy_cells) * step, 1.0 + 5.0 * 0.2);
}

}  // namespace
}  // namespace gdtslam
