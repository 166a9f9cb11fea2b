// What holds the keyframes of a straight path: each step by both sources, and stretches of 4, 12 and 30.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/mapping/back_end/held_path.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kKeyframes = 41;

/// A quarter of a metre a step, by the front end to a centimetre and three milliradians, by the wheels to two.
FrontEndPath straight_path() {
  FrontEndPath path;
  for (std::size_t i = 0; i < kKeyframes; ++i) {
    const Pose2 step{i == 0 ? 0.0 : 0.25, 0.0, 0.0};
    path.poses.push_back(Pose2{0.25 * static_cast<double>(i), 0.0, 0.0});
    const MeasuredStep by_front_end{step, Matrix3::diagonal(1.0e4, 1.0e4, 1.0e5)};
    const MeasuredStep by_wheels{step, Matrix3::diagonal(2.5e3, 2.5e3, 1.0e5)};
    path.steps.push_back({by_front_end, by_wheels});
  }
  return path;
}

class HeldPath : public testing::Test {
 protected:
  [[nodiscard]] std::vector<PoseRelation> of(const std::vector<std::size_t>& kept) const {
    return held_path(MeasuredPath(path_, {0, kKeyframes - 1}), kept);
  }
  static std::ptrdiff_t spans(const std::vector<PoseRelation>& held, std::size_t span) {
    return std::count_if(held.begin(), held.end(), [&](const PoseRelation& r) { return r.to - r.from == span; });
  }
  const FrontEndPath path_ = straight_path();
};

TEST_F(HeldPath, HasStepsOfBothAndStretches) {
  std::vector<std::size_t> all(kKeyframes);
  for (std::size_t i = 0; i < kKeyframes; ++i) all[i] = i;
  const std::vector<PoseRelation> held = of(all);
  EXPECT_EQ(spans(held, 1), 2 * 40);
  EXPECT_EQ(spans(held, 4), 37) << "one from each keyframe";
  EXPECT_EQ(spans(held, 12), 10) << "one from each third";
  EXPECT_EQ(spans(held, 30), 2) << "one from each seventh";
  EXPECT_EQ(held.size(), 80U + 37U + 10U + 2U);
  for (const PoseRelation& relation : held) {
    const auto steps = static_cast<double>(relation.to - relation.from);
    EXPECT_NEAR(relation.T_from_to.x_m, 0.25 * steps, 1.0e-9);
    if (relation.to - relation.from == 1) continue;
    // Variances of steps add up, a centimetre's more; three spans count once together, four times over each step.
    const Matrix3 covariance = inverse(relation.information);
    EXPECT_NEAR(covariance(0, 0), 12.0 * (1.0e-4 * steps + 1.0e-4), 1.0e-9) << steps;
    EXPECT_NEAR(covariance(2, 2), 12.0 * (1.0e-5 * steps + 9.0e-6), 1.0e-10) << steps;
  }
  EXPECT_NEAR(held[0].information(0, 0), 0.3 * 2.5e3, 1.0e-6) << "wheels";
  EXPECT_NEAR(held[1].information(0, 0), 0.05 * 1.0e4, 1.0e-6) << "the front end";
}

// Keyframe 20 is not kept: the step over it is one, and no stretch has it in its middle.
TEST_F(HeldPath, StretchesAreOfThoseThatAllAreKept) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < kKeyframes; ++i) {
    if (i != 20) kept.push_back(i);
  }
  const std::vector<PoseRelation> held = of(kept);
  EXPECT_EQ(spans(held, 1), 2 * 39);
  EXPECT_EQ(spans(held, 4), 16 + 16) << "within 0 to 19 and within 21 to 40";
  EXPECT_EQ(spans(held, 12), 3 + 3) << "from 0, 3, 6 and from the kept 21, 24, 27";
  EXPECT_EQ(spans(held, 30), 0);
  for (const PoseRelation& relation : held) {
    EXPECT_NEAR(relation.T_from_to.x_m, 0.25 * static_cast<double>(kept[relation.to] - kept[relation.from]), 1.0e-9);
  }
}

TEST_F(HeldPath, OfFewKeyframesHasNoStretch) {
  EXPECT_TRUE(of({}).empty());
  EXPECT_TRUE(of({7}).empty());
  EXPECT_EQ(of({0, 1, 2, 3}).size(), 6U);
  EXPECT_EQ(of({0, 1, 2, 3, 4}).size(), 9U);
}

// Nodes are the keyframes 0, 10, 20 and 40, of which 20 is not kept and 40 is the fourth that is.
TEST(HeldLoops, AreThoseThatAreOnBetweenKeptKeyframes) {
  const std::vector<std::size_t> places = {0, 10, 20, 40};
  const std::vector<std::size_t> kept = {0, 5, 10, 40};
  const Matrix3 information = Matrix3::diagonal(400.0, 900.0, 1.0e4);
  const auto loop = [&](std::size_t from, std::size_t to, double weight) {
    return Loop{{from, to, Pose2{0.5, -4.0, 0.1}, information}, weight};
  };
  PoseGraph graph;
  graph.loops = {loop(0, 3, 0.5), loop(0, 2, 1.0), loop(1, 3, 0.1)};
  const std::vector<PoseRelation> held = held_loops(graph, places, kept);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].from, 0U);
  EXPECT_EQ(held[0].to, 3U);
  EXPECT_NEAR(held[0].T_from_to.y_m, -4.0, 1.0e-12);
  EXPECT_NEAR(held[0].information(1, 1), 0.5 * 900.0, 1.0e-9) << "times its weight";
}

}  // namespace
}  // namespace gdtslam
