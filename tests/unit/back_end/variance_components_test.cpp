// Drives around a block by wheels that are better or worse than they say, with loops that are as good as they say.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/mapping/graph/variance_components.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBlock = 40;
constexpr std::size_t kPoses = 12 * kBlock;

struct Sigmas {
  double m = 0.0;
  double rad = 0.0;
  [[nodiscard]] Matrix3 information() const {
    return Matrix3::diagonal(1.0 / (m * m), 1.0 / (m * m), 1.0 / (rad * rad));
  }
};
constexpr Sigmas kStated{0.02, 0.004};
constexpr Sigmas kLoop{0.01, 0.002};

Pose2 around_the_block(std::size_t i) {
  Pose2 pose;
  for (std::size_t k = 0; k < i % kBlock; ++k) {
    pose = pose * (k % 10 == 9 ? Pose2{1.0, 0.0, 0.5 * kPi} : Pose2{1.0, 0.0, 0.0});
  }
  return pose;
}

PoseRelation measured(std::size_t from, std::size_t to, const Sigmas& real, const Sigmas& stated, Random& random) {
  const double x = random.normal(0.0, real.m);
  const double y = random.normal(0.0, real.m);
  const double turn = random.normal(0.0, real.rad);
  return {from, to, between(around_the_block(from), around_the_block(to)) * exp_tangent({x, y, turn}),
          stated.information()};
}

std::vector<PoseRelation> drive(const Sigmas& real, Random& random) {
  std::vector<PoseRelation> chain;
  for (std::size_t i = 1; i < kPoses; ++i) chain.push_back(measured(i - 1, i, real, kStated, random));
  return chain;
}

std::vector<Loop> loops_of(double wrong_share, Random& random) {
  std::vector<Loop> loops;
  for (std::size_t i = kBlock; i < kPoses; ++i) {
    Loop loop{measured(i - kBlock, i, kLoop, kLoop, random), 1.0};
    if (random.uniform(0.0, 1.0) < wrong_share)
      loop.relation.T_from_to = loop.relation.T_from_to * Pose2{8.5, 0.0, 0.0};
    loops.push_back(loop);
  }
  return loops;
}

// A factor of the variances is the square of that of the errors; the grid of four a decade and loops that share the
// path leave a factor of three.
TEST(VarianceFactor, IsThatOfTheErrorsSquared) {
  for (const double worse : {0.2, 1.0, 5.0}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      Random random(seed);
      const std::vector<PoseRelation> chain = drive({worse * kStated.m, worse * kStated.rad}, random);
      const double found = variance_factor(chain, loops_of(0.0, random)).variance;
      EXPECT_GT(found, worse * worse / 3.0) << worse << ", seed " << seed;
      EXPECT_LT(found, 3.0 * worse * worse) << worse << ", seed " << seed;
    }
  }
}

TEST(VarianceFactor, IsNotMovedFarByWrongLoops) {
  Random random(4);
  const std::vector<PoseRelation> chain = drive(kStated, random);
  const double found = variance_factor(chain, loops_of(0.1, random)).variance;
  EXPECT_GT(found, 1.0 / 3.0);
  EXPECT_LT(found, 3.0);
}

TEST(VarianceFactor, IsAsStatedWhereFewLoopsAreOn) {
  Random random(5);
  const std::vector<PoseRelation> chain = drive({0.2, 0.04}, random);
  std::vector<Loop> loops = loops_of(0.0, random);
  for (std::size_t i = 3; i < loops.size(); ++i) loops[i].weight = 0.0;
  const VarianceFactor found = variance_factor(chain, loops);
  EXPECT_EQ(found.variance, 1.0);
  EXPECT_EQ(found.closures, 0U);
}

TEST(RescaledRelation, HasACovarianceSoMuchLarger) {
  Random random(6);
  const PoseRelation relation = measured(3, 4, kStated, kStated, random);
  const Matrix3 covariance = inverse(rescaled(relation, {.variance = 4.0}).information);
  EXPECT_NEAR(covariance(0, 0), 4.0 * 0.02 * 0.02, 1.0e-12);
  EXPECT_NEAR(covariance(2, 2), 4.0 * 0.004 * 0.004, 1.0e-12);
}

}  // namespace
}  // namespace gdtslam
