// Simplex, window search and matcher on the exact field of a known room. Truth comes from the room's geometry, the
// optimum of a window from nested loops.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/exhaustive.hpp"
#include "engine/mapping/match/scan_matcher.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/pose_matchers.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

class Matching : public testing::Test {
 protected:
  // Maps the room from a few true poses.
  void SetUp() override {
    for (const Pose2& pose : {Pose2{}, Pose2{0, 0, 2.0}, Pose2{0, 0, -2.0}, Pose2{3.9, 0.2, 0.3}, Pose2{2.5, -1, 3}}) {
      const auto points = in_map(to_points(test::scan_of(walls_, pose, 0.0), {0.1, 40.0}), pose);
      const KeyframeCells keyframe = make_keyframe_cells(points, resolution_m_, radius_);
      const MergeStep step{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};
      map_.grow_to_hold(keyframe.window);
      local_.prepare(keyframe, map_);
      local_.merge_into(map_, step);
    }
  }

  std::vector<PointCells> scan_from(const Pose2& pose) const {
    return in_cells(to_points(test::scan_of(walls_, pose, 0.0), {0.1, 40.0}), resolution_m_);
  }

  std::vector<test::Segment> walls_ = test::furnished_room();
  MapperConfig config_;
  double resolution_m_ = config_.map.resolution_m;
  std::uint32_t radius_ = config_.map.radius_cells();
  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField map_{*backend_, resolution_m_, radius_, 1U << 24U};
  LocalField local_{*backend_, radius_};
};

TEST_F(Matching, SimplexFindsThePoseFromNearby) {
  const Pose2 truth{0.31, -0.17, 0.21};
  const auto points = scan_from(truth);
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_points(points);
  objective.set_cap(map_.cap());
  const LocalMinimum found = minimise_simplex(objective, objective.to_cells({0.24, -0.11, 0.24}), {});
  EXPECT_EQ(found.stop, StopReason::kConverged);
  EXPECT_THAT(objective.to_metres(found.pose), PoseNear(truth, 0.02, 0.3));
  EXPECT_EQ(found.cost, objective.evaluate(found.pose));
}

TEST_F(Matching, SimplexNeverEndsWorseThanItStartsAndKeepsToItsLimit) {
  const auto points = scan_from({0.3, 0.1, 0.0});
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_points(points);
  objective.set_cap(map_.cap());
  for (int i = 0; i < 50; ++i) {
    const CellPose start{static_cast<float>(i % 7) - 3.0F, static_cast<float>(i % 5), static_cast<float>(i) * 0.06F};
    const LocalMinimum found = minimise_simplex(objective, start, {.max_evaluations = 40});
    EXPECT_LE(found.cost, objective.evaluate(start));
    EXPECT_LE(found.evaluations, 40U + 5U) << "one move more at most";
  }
}

TEST_F(Matching, APriorPullsTowardsItsMeanAndOnlyThen) {
  const auto points = scan_from({0.3, 0.0, 0.1});
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_points(points);
  objective.set_cap(map_.cap());
  const CellPose pose = objective.to_cells({0.5, 0.1, 0.2});
  const std::uint32_t without = objective.evaluate(pose);
  objective.set_prior({.mean_x = pose.x - 3.0F,
                       .mean_y = pose.y + 4.0F,
                       .mean_theta = pose.theta - 0.5F,
                       .weight_xy = 2.0F,
                       .weight_theta = 8.0F});
  EXPECT_EQ(objective.evaluate(pose), without + 50 + 2);
  objective.set_prior({});
  EXPECT_EQ(objective.evaluate(pose), without);
}

// What every matcher must do.
class MatchersOfAScan : public Matching, public testing::WithParamInterface<MatcherKind> {
 protected:
  void SetUp() override {
    Matching::SetUp();
    config_.match.matcher = GetParam();
    matcher_ = std::make_unique<ScanMatcher>(config_, map_);
  }

  std::unique_ptr<ScanMatcher> matcher_;
};

TEST_P(MatchersOfAScan, FindTheTruthFromNearby) {
  for (const Pose2& truth : {Pose2{0.31, -0.17, 0.21}, Pose2{2.2, 0.4, -1.1}, Pose2{3.7, -0.6, 2.9}}) {
    const Pose2 predicted = truth * Pose2{0.05, -0.04, 0.06};
    const MatchResult result = matcher_->match(
        scan_from(truth), {.T_map_base = predicted, .travelled_m = 0.1, .turned_rad = 0.1, .by_odometry = true}, false);
    EXPECT_TRUE(result.accepted);
    EXPECT_EQ(result.doubt, Doubt::kNone);
    EXPECT_EQ(result.stop, StopReason::kConverged);
    EXPECT_EQ(result.T_map_predicted, predicted);
    EXPECT_THAT(result.T_map_base, PoseNear(truth, 0.02, 0.3));
    EXPECT_GT(result.overlap, 0.9);
    EXPECT_LT(result.contradiction, 0.05);
    EXPECT_LT(result.mean_cost_m, 0.04);
    EXPECT_GT(result.evaluations, 50U);
  }
}

TEST_P(MatchersOfAScan, CureAFarPredictionByAWindow) {
  const Pose2 truth{0.2, 0.1, 0.4};
  for (const Pose2& error : {Pose2{0.4, -0.3, 0.4}, Pose2{-0.45, 0.2, -0.6}, Pose2{0.1, 0.1, 1.2}}) {
    const MatchResult result =
        matcher_->match(scan_from(truth), {.T_map_base = truth * error, .travelled_m = 0.1, .turned_rad = 0.1}, false);
    EXPECT_GT(result.attempts, 0U);
    EXPECT_TRUE(result.accepted);
    EXPECT_THAT(result.T_map_base, PoseNear(truth, 0.03, 0.5));
    EXPECT_GT(result.overlap, 0.9);
    EXPECT_LT(result.contradiction, 0.05);
  }
}

TEST_P(MatchersOfAScan, RefuseAScanOfAnotherRoomAndKeepThePrediction) {
  // A round room of 1.3 m fits nowhere in the rectangular one.
  std::vector<PointCells> circle;
  for (int i = 0; i < 180; ++i) {
    const double a = rad_from_deg(2.0 * i);
    circle.push_back(
        {static_cast<float>(std::cos(a) * 1.3 / resolution_m_), static_cast<float>(std::sin(a) * 1.3 / resolution_m_)});
  }
  const Pose2 predicted{4.5, 0.3, 0.0};
  const MatchResult result = matcher_->match(
      circle, {.T_map_base = predicted, .travelled_m = 0.1, .turned_rad = 0.1, .by_odometry = true}, false);
  EXPECT_FALSE(result.accepted) << result.overlap << " " << result.contradiction;
  EXPECT_NE(result.doubt, Doubt::kNone);
  EXPECT_EQ(result.T_map_base, predicted);
}

TEST_P(MatchersOfAScan, TakeAsManyPointsAsThereMayBe) {
  const Pose2 truth{0.31, -0.17, 0.21};
  std::vector<PointCells> points;
  while (points.size() < kMostMatchedPoints) {
    for (const PointCells& point : scan_from(truth)) points.push_back(point);
  }
  points.resize(kMostMatchedPoints);
  const MatchResult result =
      matcher_->match(points, {.T_map_base = truth * Pose2{0.03, 0.02, 0.03}, .by_odometry = true}, false);
  EXPECT_EQ(result.points, kMostMatchedPoints);
  EXPECT_THAT(result.T_map_base, PoseNear(truth, 0.02, 0.3));
}

INSTANTIATE_TEST_SUITE_P(All, MatchersOfAScan, testing::Values(MatcherKind::kSimplex, MatcherKind::kExhaustive),
                         [](const auto& kind) {
                           return kind.param == MatcherKind::kSimplex ? "simplex" : "exhaustive";
                         });

// Those that cover it are many more than the matcher may open.
TEST_F(Matching, BoxesThatCoverAWideWindowDoNotCountAsOpened) {
  config_.match.matcher = MatcherKind::kCertified;
  config_.search.max_kiloboxes = 20;
  ScanMatcher matcher(config_, map_);
  const Pose2 truth{0.2, 0.1, 0.4};
  const Pose2 predicted = truth * Pose2{1.5, -0.4, 2.4};
  const MatchResult result =
      matcher.match(scan_from(truth), {.T_map_base = predicted, .travelled_m = 2.5, .turned_rad = 2.6}, false);
  EXPECT_TRUE(result.accepted);
  EXPECT_THAT(result.T_map_base, PoseNear(truth, 0.03, 0.5));
}

// Devices may take subnormal numbers for 0, so nothing near them is handed to one.
TEST_F(Matching, APredictionNextToNothingIsZero) {
  MatchRules rules(config_);
  rules.begin({.T_map_base = {1.0e-42, -1.0e-41, 1.0e-40}}, 100);
  const PriorParams& prior = rules.prior();
  const CellPose mean{prior.mean_x, prior.mean_y, prior.mean_theta};
  for (const CellPose& pose : {rules.predicted(), rules.window(1.0).centre, mean}) {
    EXPECT_EQ(pose.x, 0.0F);
    EXPECT_EQ(pose.theta, 0.0F);
  }
  rules.begin({.T_map_base = {1.0e-20, 0.0, -1.0e-25}}, 100);
  EXPECT_FLOAT_EQ(rules.predicted().x, static_cast<float>(1.0e-20 / resolution_m_));
  EXPECT_FLOAT_EQ(rules.predicted().theta, -1.0e-25F);
}

// The whole window matcher against loops over its definition: the pose that it ends at costs no more, in points and
// prior, than any sample of the window.
TEST_F(Matching, NoSampleOfTheWindowBeatsWhatExhaustiveFinds) {
  const Pose2 truth{0.4, -0.3, 0.5};
  const std::vector<PointCells> points = scan_from(truth);
  const Prediction prediction{
      .T_map_base = truth * Pose2{0.15, 0.1, -0.1}, .travelled_m = 0.3, .turned_rad = 0.2, .by_odometry = true};
  config_.match.matcher = MatcherKind::kExhaustive;
  ScanMatcher matcher(config_, map_);
  const MatchResult result = matcher.match(points, prediction, false);
  EXPECT_EQ(result.attempts, 1U);

  MatchRules rules(config_);
  rules.begin(prediction, points.size());
  Objective objective(map_, config_.match.interpolation, config_.match.cost);
  objective.set_points(points);
  objective.set_anchor(rules.anchor());
  objective.set_prior(rules.prior());
  objective.set_cap(rules.wide_gate());
  const std::uint32_t found = objective.evaluate(objective.to_cells(result.T_map_base));
  const SearchWindow window = rules.window(1.0);
  std::uint32_t samples = 0;
  const auto offset = [](std::uint32_t i, std::uint32_t count) {
    const std::uint32_t middle = count / 2;
    return static_cast<float>(i) - static_cast<float>(middle);
  };
  for (std::uint32_t t = 0; t < window.count_theta(); ++t) {
    for (std::uint32_t y = 0; y < window.count_xy(); ++y) {
      for (std::uint32_t x = 0; x < window.count_xy(); ++x, ++samples) {
        ASSERT_LE(found, objective.evaluate({window.centre.x + offset(x, window.count_xy()) * window.step_cells,
                                             window.centre.y + offset(y, window.count_xy()) * window.step_cells,
                                             window.centre.theta + offset(t, window.count_theta()) * window.step_rad}));
      }
    }
  }
  EXPECT_GT(result.evaluations, samples) << "descents count too";
}

}  // namespace
}  // namespace gdtslam
