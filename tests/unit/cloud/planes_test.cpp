// find_planes in rooms whose planes are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/cloud/plane.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::Rectangle;
using test::strew;
using test::strew_outliers;

// Of the patches the one whose plane comes nearest to a rectangle.
const PlanePatch* patch_on(const std::vector<PlanePatch>& patches, const Rectangle& rectangle) {
  const Point3 middle = rectangle.corner + 0.5 * rectangle.side + 0.5 * rectangle.other;
  const auto is_on = [&](const PlanePatch& patch) {
    return std::fabs(patch.plane.normal.dot(rectangle.normal())) > 0.99 &&
           std::fabs(patch.plane.distance_m(middle)) < 0.05;
  };
  const auto found = std::find_if(patches.begin(), patches.end(), is_on);
  return found == patches.end() ? nullptr : &*found;
}

// The truth lies within the stated uncertainty: the offset at the patch's centre, the direction of the normal.
void expect_within_three_sigma(const PlanePatch& patch, const Rectangle& truth) {
  const double off_m = truth.normal().dot(patch.centre - truth.corner);
  EXPECT_LE(std::fabs(off_m), 3.0 * patch.sigma_centre_m) << "sigma " << patch.sigma_centre_m;
  const double off_rad = patch.plane.normal.cross(truth.normal()).norm();
  EXPECT_LE(off_rad, 3.0 * std::sqrt(2.0) * patch.sigma_normal_rad) << "sigma " << patch.sigma_normal_rad;
}

TEST(FindPlanes, RecoversTheSixPlanesOfANoisyRoomWithOutliers) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Random random(seed);
    const std::vector<Rectangle> room = test::room({6.0, 4.0, 2.5});
    Cloud cloud;
    for (const Rectangle& wall : room) strew(cloud, wall, 20'000, 0.01, random);
    strew_outliers(cloud, {3.0, 2.0, 1.25}, 2.0, 10'000, random);
    PlaneSearch search;
    search.max_planes = 6;
    const std::vector<PlanePatch> patches = find_planes(cloud, search);
    ASSERT_EQ(patches.size(), 6U);
    for (const Rectangle& wall : room) {
      const PlanePatch* patch = patch_on(patches, wall);
      ASSERT_NE(patch, nullptr);
      expect_within_three_sigma(*patch, wall);
      // Cut at three standard deviations, with a few outliers among them.
      EXPECT_NEAR(patch->rms_m, 0.0099, 0.0004);
      EXPECT_GT(patch->points.size(), 19'000U);
      EXPECT_TRUE(std::is_sorted(patch->points.begin(), patch->points.end()));
    }
  }
}

TEST(FindPlanes, TheLargestComesFirst) {
  Random random(4);
  Cloud cloud;
  // As many points on the small one: area counts, not density.
  strew(cloud, {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}}, 20'000, 0.005, random);
  strew(cloud, {{0, 0, 2}, {3, 0, 0}, {0, 3, 0}}, 20'000, 0.005, random);
  const std::vector<PlanePatch> patches = find_planes(cloud, {});
  ASSERT_EQ(patches.size(), 2U);
  EXPECT_NEAR(patches[0].centre.z(), 2.0, 0.01);
  EXPECT_NEAR(patches[1].centre.z(), 0.0, 0.01);
}

TEST(FindPlanes, OnePlaneWithAGapIsTwoPatches) {
  Random random(5);
  Cloud cloud;
  strew(cloud, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 20'000, 0.005, random);
  strew(cloud, {{3, 0, 0}, {1, 0, 0}, {0, 2, 0}}, 10'000, 0.005, random);
  PlaneSearch search;
  search.gap_m = 0.25;
  std::vector<PlanePatch> patches = find_planes(cloud, search);
  ASSERT_EQ(patches.size(), 2U);
  EXPECT_NEAR(patches[0].centre.x(), 1.0, 0.02);
  EXPECT_NEAR(patches[1].centre.x(), 3.5, 0.02);
  search.gap_m = 2.5;
  patches = find_planes(cloud, search);
  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(patches[0].points.size(), cloud.size());
}

TEST(FindPlanes, AnotherSurfaceInTheGapConnectsNothing) {
  Random random(9);
  Cloud cloud;
  strew(cloud, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 20'000, 0.005, random);
  strew(cloud, {{3, 0, 0}, {1, 0, 0}, {0, 2, 0}}, 10'000, 0.005, random);
  strew(cloud, {{2, 0, 0.05}, {0.5, 0, 0.5}, {0, 2, 0}}, 10'000, 0.005, random);  // a roof over the gap
  strew(cloud, {{2.5, 0, 0.55}, {0.5, 0, -0.5}, {0, 2, 0}}, 10'000, 0.005, random);
  for (const PlanePatch& patch : find_planes(cloud, {})) {
    if (std::fabs(patch.plane.normal.z()) < 0.95) continue;
    EXPECT_TRUE(std::fabs(patch.centre.x() - 1.0) < 0.05 || std::fabs(patch.centre.x() - 3.5) < 0.05) << patch.centre;
  }
}

TEST(FindPlanes, NoPointBelongsToTwoPatchesAndTheLimitsHold) {
  Random random(6);
  Cloud cloud;
  for (const Rectangle& wall : test::room({3.0, 3.0, 2.5})) strew(cloud, wall, 5'000, 0.01, random);
  PlaneSearch search;
  const std::vector<PlanePatch> patches = find_planes(cloud, search);
  std::vector<int> owners(cloud.size(), 0);
  for (const PlanePatch& patch : patches) {
    EXPECT_GE(patch.points.size(), search.min_points);
    for (const std::uint32_t k : patch.points) ++owners[k];
  }
  EXPECT_LE(*std::max_element(owners.begin(), owners.end()), 1);
  search.max_planes = 2;
  EXPECT_EQ(find_planes(cloud, search).size(), 2U);
  search.min_points = 1'000'000;
  EXPECT_TRUE(find_planes(cloud, search).empty());
}

TEST(FindPlanes, TheSameCloudGivesTheSamePlanes) {
  Random random(7);
  Cloud cloud;
  for (const Rectangle& wall : test::room({5.0, 4.0, 2.5})) strew(cloud, wall, 6'000, 0.01, random);
  strew_outliers(cloud, {2.5, 2.0, 1.2}, 1.5, 3'000, random);
  const std::vector<PlanePatch> once = find_planes(cloud, {});
  const std::vector<PlanePatch> again = find_planes(cloud, {});
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(once[k].points, again[k].points);
    EXPECT_EQ(once[k].plane.normal, again[k].plane.normal);
    EXPECT_EQ(once[k].plane.offset_m, again[k].plane.offset_m);
  }
}

TEST(FindPlanes, CloudsWithoutAPlaneHaveNone) {
  EXPECT_TRUE(find_planes({}, {}).empty());
  Cloud cloud(1'000, test::cloud_point({1.0, 2.0, 3.0}));  // one place
  EXPECT_TRUE(find_planes(cloud, {}).empty());
  for (std::size_t k = 0; k < cloud.size(); ++k) cloud[k].x_m = static_cast<float>(k) * 0.01F;  // a line
  EXPECT_TRUE(find_planes(cloud, {}).empty());
  cloud.assign(2, test::cloud_point({0.0, 0.0, 0.0}));
  EXPECT_TRUE(find_planes(cloud, {}).empty());
}

TEST(FindPlanes, PointsThatAreNotFiniteOrFarAwayDoNoHarm) {
  Random random(8);
  Cloud cloud;
  strew(cloud, {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 10'000, 0.005, random);
  cloud.push_back(test::cloud_point({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  cloud.push_back(test::cloud_point({0.0, std::numeric_limits<double>::infinity(), 0.0}));
  const std::vector<PlanePatch> patches = find_planes(cloud, {});
  ASSERT_EQ(patches.size(), 1U);
  EXPECT_EQ(patches[0].points.size(), 10'000U);
  cloud.push_back(test::cloud_point({1.0e6, -1.0e6, 1.0e6}));
  EXPECT_FALSE(find_planes(cloud, {}).empty());
}

}  // namespace
}  // namespace gdtslam
