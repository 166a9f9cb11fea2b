// The side of a box that is seen at a low angle, from hits whose errors run along their beams.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/cloud/box_face.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr double kNoise_m = 0.01;
constexpr double kEyeBefore_m = 1.8;
constexpr double kEyeAlong_m = 0.25;  // beside the end: beams meet the side at about 8 deg

EndPlace place_at_the_end() {
  return {.axis = FaceAxis::kAcross,
          .sign = 1.0,
          .rough_m = 0.0,
          .beside = {-1.0, 1.0},
          .eye_along_m = kEyeAlong_m,
          .eye_before_m = kEyeBefore_m};
}

// A side at along = 0 from depth 0 to 0.4, straight back.
std::vector<FaceHit> hits_on_the_side(Random& random) {
  std::vector<FaceHit> hits;
  for (int k = 0; k < 3'000; ++k) {
    const double depth_m = random.uniform(0.0, 0.4);
    const double length_m = std::sqrt((depth_m + kEyeBefore_m) * (depth_m + kEyeBefore_m) + kEyeAlong_m * kEyeAlong_m);
    const double longer = 1.0 + random.normal(0.0, kNoise_m) / length_m;
    FaceHit hit;
    hit.depth_m = longer * (depth_m + kEyeBefore_m) - kEyeBefore_m;
    hit.point_across_m = kEyeAlong_m - longer * kEyeAlong_m;
    hits.push_back(hit);
  }
  return hits;
}

TEST(BoxSide, ErrorsAlongTheBeamsDoNotTurnIt) {
  Random random(1);
  double squares = 0.0;
  constexpr int kDraws = 40;
  for (int k = 0; k < kDraws; ++k) {
    const std::optional<SideFace> side = side_at(hits_on_the_side(random), place_at_the_end(), 0.02, 1.0);
    ASSERT_TRUE(side.has_value());
    const double in_sigmas = side->slope / side->sigma_slope;
    squares += in_sigmas * in_sigmas;
    EXPECT_LT(std::fabs(side->crease.at_m), 5.0 * side->crease.sigma_m);
    EXPECT_GT(side->deepest_m, 0.38);
  }
  // Chi-squared with 40 degrees of freedom; its 0.1 % quantile above is 73. Not less than half: sigmas are no excuse.
  EXPECT_LT(squares, 73.4);
  EXPECT_GT(squares, 10.0);
}

TEST(BoxSide, AWallFarBehindIsNoSide) {
  Random random(2);
  std::vector<FaceHit> hits;
  for (int k = 0; k < 2'000; ++k) {
    FaceHit hit;
    hit.depth_m = 0.8 + random.normal(0.0, kNoise_m);
    hit.point_across_m = random.uniform(-0.05, 0.3);
    hits.push_back(hit);
  }
  EXPECT_FALSE(side_at(hits, place_at_the_end(), 0.02, 1.0).has_value());
  EXPECT_FALSE(side_at({}, place_at_the_end(), 0.02, 1.0).has_value());
}

TEST(FaceEnd, LiesBetweenTheBeamsAndSaysHowFarTheyAreApart) {
  // Beams every 8 mm in every row alike: the end at 0.0512 is somewhere between 0.048 and 0.056.
  std::vector<FaceHit> hits;
  for (int row = 0; row < 50; ++row) {
    for (int beam = -20; beam < 40; ++beam) {
      FaceHit hit;
      hit.across_m = hit.point_across_m = 0.008 * beam;
      hit.depth_m = hit.across_m < 0.0512 ? 0.001 : 1.0;
      hits.push_back(hit);
    }
  }
  EndPlace place{
      .sign = 1.0, .rough_m = 0.05, .sampling_m = 0.008, .beside = {-1.0, 1.0}, .eye_along_m = {}, .eye_before_m = 0.0};
  const FaceEnd end = find_end(hits, place, 0.03);
  EXPECT_EQ(end.kind, EndKind::kJump);
  EXPECT_NEAR(end.at_m, 0.052, 5e-4);
  EXPECT_NEAR(end.sigma_m, 0.008 / std::sqrt(12.0), 8e-4);  // evenly likely over the gap
}

TEST(FaceEnd, IsExactWhereRowsAreShifted) {
  Random random(3);
  std::vector<FaceHit> hits;
  for (int row = 0; row < 200; ++row) {
    const double shift_m = random.uniform(0.0, 0.008);
    for (int beam = -20; beam < 40; ++beam) {
      FaceHit hit;
      hit.across_m = hit.point_across_m = -(0.008 * beam + shift_m);  // the low end
      hit.depth_m = hit.across_m > -0.0512 ? 0.001 : 1.0;
      hits.push_back(hit);
    }
  }
  const EndPlace place{.sign = -1.0,
                       .rough_m = -0.05,
                       .sampling_m = 0.008,
                       .beside = {-1.0, 1.0},
                       .eye_along_m = {},
                       .eye_before_m = 0.0};
  const FaceEnd end = find_end(hits, place, 0.03);
  EXPECT_NEAR(end.at_m, -0.0512, 2e-4);
  EXPECT_LT(end.sigma_m, 2e-4);
  EXPECT_GT(end.sigma_m, 1e-5);
}

}  // namespace
}  // namespace gdtslam
