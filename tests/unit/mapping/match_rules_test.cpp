// Where a robot can be, and how far a search for it goes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <vector>

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

// The rules at their limits, with the configuration's defaults; a cell is 0.025 m, 256 units.
class RulesAtTheirLimits : public testing::Test {
 protected:
  void begin(bool by_odometry = true, double travelled_m = 0.5, double turned_rad = 0.2) {
    Prediction prediction{.T_map_base = kPredicted};
    prediction.travelled_m = travelled_m;
    prediction.turned_rad = turned_rad;
    prediction.by_odometry = by_odometry;
    rules_.begin(prediction, 100);
  }
  // A pose that is off by so much of a limit in one coordinate.
  [[nodiscard]] CellPose off(double x_m, double y_m, double rad) const {
    CellPose pose = rules_.predicted();
    pose.x += static_cast<float>(x_m / 0.025);
    pose.y += static_cast<float>(y_m / 0.025);
    pose.theta += static_cast<float>(rad);
    return pose;
  }
  static Evidence good() { return {.mean_cost_m = 0.01, .overlap = 0.9, .contradiction = 0.0}; }

  MapperConfig config_;
  MatchRules rules_{config_};
};

TEST_F(RulesAtTheirLimits, APoseIsFarBeyondTheDistanceOrTheAngleEitherWay) {
  begin();
  const double m = rules_.far_m();
  const double rad = rules_.far_rad();
  for (const double sign : {1.0, -1.0}) {
    EXPECT_FALSE(rules_.is_far(off(sign * 0.999 * m, 0.0, 0.0)));
    EXPECT_TRUE(rules_.is_far(off(sign * 1.001 * m, 0.0, 0.0)));
    EXPECT_FALSE(rules_.is_far(off(0.0, sign * 0.999 * m, 0.0)));
    EXPECT_TRUE(rules_.is_far(off(0.0, sign * 1.001 * m, 0.0)));
    EXPECT_TRUE(rules_.is_far(off(0.8 * m, sign * 0.8 * m, 0.0))) << "1.13 times as far, across";
    EXPECT_FALSE(rules_.is_far(off(0.0, 0.0, sign * 0.999 * rad)));
    EXPECT_TRUE(rules_.is_far(off(0.0, 0.0, sign * 1.001 * rad)));
  }
}

TEST_F(RulesAtTheirLimits, EvidenceIsTheSharesOfTheCounts) {
  begin();
  const Evidence evidence = rules_.evidence({.sum = 100 * 512, .near = 75, .beside = 6, .known = 60});
  EXPECT_NEAR(evidence.mean_cost_m, 2.0 * 0.025, 1e-12);  // 512 units are two cells
  EXPECT_EQ(evidence.overlap, 0.75);
  EXPECT_EQ(evidence.contradiction, 0.1);
  EXPECT_FALSE(rules_.is_suspect(evidence)) << "both at their limits";
  EXPECT_EQ(rules_.evidence({.sum = 0, .near = 0, .beside = 3, .known = 0}).contradiction, 0.0) << "nothing is known";
  EXPECT_TRUE(rules_.is_suspect(rules_.evidence({.sum = 0, .near = 74, .beside = 0, .known = 60})));
  EXPECT_TRUE(rules_.is_suspect(rules_.evidence({.sum = 0, .near = 100, .beside = 7, .known = 60})));
}

TEST_F(RulesAtTheirLimits, AMatchIsRefusedBeyondWhatIsStatedAndThePredictionStands) {
  begin();
  const CellPose pose = off(0.05, -0.05, 0.02);
  const auto judged = [&](double overlap, double contradiction) {
    return rules_.judged(pose, {.mean_cost_m = 0.02, .overlap = overlap, .contradiction = contradiction});
  };
  for (const auto& [overlap, contradiction, doubt] :
       {std::tuple{0.9, 0.0, Doubt::kNone}, std::tuple{0.25, 0.0, Doubt::kWeakEvidence},
        std::tuple{0.9, 0.3, Doubt::kWeakEvidence}, std::tuple{0.2499, 0.0, Doubt::kLowOverlap},
        std::tuple{0.9, 0.3001, Doubt::kContradiction}, std::tuple{0.0, 1.0, Doubt::kContradiction}}) {
    const MatchResult result = judged(overlap, contradiction);
    const bool is_accepted = doubt == Doubt::kNone || doubt == Doubt::kWeakEvidence;
    EXPECT_EQ(to_string(result.doubt), to_string(doubt));
    EXPECT_EQ(result.accepted, is_accepted);
    EXPECT_EQ(result.overlap, overlap);
    EXPECT_EQ(result.contradiction, contradiction);
    EXPECT_EQ(result.mean_cost_m, 0.02);
    EXPECT_EQ(result.points, 100U);
    EXPECT_EQ(result.T_map_predicted, kPredicted);
    if (is_accepted) {
      EXPECT_NEAR(result.T_map_base.x_m, kPredicted.x_m + 0.05, 1e-6);
      EXPECT_NEAR(result.T_map_base.y_m, kPredicted.y_m - 0.05, 1e-6);
      EXPECT_NEAR(result.T_map_base.theta_rad, kPredicted.theta_rad + 0.02, 1e-6);
    } else {
      EXPECT_EQ(result.T_map_base, kPredicted);
    }
  }
}

TEST_F(RulesAtTheirLimits, AMatchFarFromTheOdometryIsReportedEitherWay) {
  const double most_rad = 15.0 * std::numbers::pi / 180.0;
  for (const double sign : {1.0, -1.0}) {
    begin();
    EXPECT_EQ(rules_.judged(off(sign * 0.2499, 0.0, 0.0), good()).doubt, Doubt::kNone);
    EXPECT_EQ(rules_.judged(off(sign * 0.2501, 0.0, 0.0), good()).doubt, Doubt::kFarFromPrediction);
    EXPECT_EQ(rules_.judged(off(0.0, sign * 0.2501, 0.0), good()).doubt, Doubt::kFarFromPrediction);
    EXPECT_EQ(rules_.judged(off(0.0, 0.0, sign * 0.999 * most_rad), good()).doubt, Doubt::kNone);
    EXPECT_EQ(rules_.judged(off(0.0, 0.0, sign * 1.001 * most_rad), good()).doubt, Doubt::kFarFromPrediction);
    EXPECT_TRUE(rules_.judged(off(0.0, 0.0, sign * 1.001 * most_rad), good()).accepted);
    begin(false);
    EXPECT_EQ(rules_.judged(off(sign * 3.0, 0.0, 0.0), good()).doubt, Doubt::kNone) << "there is no odometry";
  }
}

}  // namespace
}  // namespace gdtslam
