// NdtMap and align_clouds: sums by hand, motions that are known, scenes that do not hold a cloud.
#include "engine/cloud/cloud_alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/cloud/ndt_map.hpp"
#include "gdtslam/core/error.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::moved;
using test::Rectangle;
using test::strew;

// A furnished room of 5 x 4 m, each time with other points on the same surfaces.
Cloud furnished_room(std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (const Rectangle& side : test::room({5.0, 4.0, 2.5})) strew(cloud, side, 4'000, 0.005, random);
  for (const Rectangle& side : test::box_sides({1.5, 1.2, 0.0}, 0.4, {1.2, 0.8, 0.9}))
    strew(cloud, side, 1'000, 0.005, random);
  return cloud;
}

TEST(NdtMap, HasTheSumsOfTheStepsFromEachCubesCentre) {
  // Steps of 1/4096 of a cube of 4.096 m are millimetres; the cube's centre is at 2.048 m on each axis.
  const Cloud cloud{{.x_m = 2.148F, .y_m = 2.048F, .z_m = 1.748F}, {.x_m = 2.048F, .y_m = 2.248F, .z_m = 2.048F}};
  const NdtSums sums = NdtMap(cloud, 4.096, 0.001).sums_at({1.0, 1.0, 1.0});
  EXPECT_EQ(sums.count, 2);
  EXPECT_EQ(sums.sum, (std::array<std::int64_t, 3>{100, 200, -300}));
  EXPECT_EQ(sums.products, (std::array<std::int64_t, 6>{10'000, 0, -30'000, 40'000, 0, 90'000}));
}

TEST(NdtMap, DoesNotDependOnTheOrderOfThePoints) {
  Cloud cloud = furnished_room(1);
  const NdtMap map(cloud, 0.5, 0.01);
  std::reverse(cloud.begin(), cloud.end());
  const NdtMap reversed(cloud, 0.5, 0.01);
  ASSERT_EQ(map.size(), reversed.size());
  EXPECT_GT(map.size(), 300U);
  for (const CloudPoint& point : cloud) {
    const Point3 at(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m));
    ASSERT_EQ(map.sums_at(at), reversed.sums_at(at));
  }
}

TEST(AlignClouds, RecoversMotionsOfUpToAMetreAndThirtyDegrees) {
  const Cloud a = furnished_room(1);
  Random random(2);
  for (std::uint64_t k = 0; k < 8; ++k) {
    Tangent3 motion;
    for (Eigen::Index i = 0; i < 6; ++i) motion[i] = random.uniform(-1.0, 1.0);
    motion.head<3>() *= 0.7 / motion.head<3>().norm();
    motion.tail<3>() *= 0.5 / motion.tail<3>().norm();
    const Pose3 middle{{2.5, 2.0, 1.0}, Eigen::Quaterniond::Identity()};  // where a scanner stands
    const Pose3 T_a_b = middle * exp_se3(motion) * inverse(middle);
    const Alignment found = align_clouds(a, moved(furnished_room(10 + k), inverse(T_a_b)), {});
    const Tangent3 off = log_se3(inverse(T_a_b) * found.T_a_b);
    EXPECT_LT(off.head<3>().norm(), 0.002) << k;
    EXPECT_LT(off.tail<3>().norm(), 0.001) << k;
    EXPECT_TRUE(found.is_believed()) << k;
    EXPECT_GT(found.after.overlap, 0.98);
    EXPECT_LT(found.after.median_m, 0.006);  // noise of 5 mm on both sides
    EXPECT_GT(found.before.median_m, 0.02);
  }
}

TEST(AlignClouds, InThePlaneOnlyThreeNumbersMove) {
  const Pose3 T_a_b = embed(Pose2{0.5, -0.4, 0.3});
  const Cloud b = moved(furnished_room(4), inverse(T_a_b));
  const Alignment found = align_clouds(furnished_room(3), b, {.is_planar = true});
  EXPECT_LT((found.T_a_b.translation_m - T_a_b.translation_m).norm(), 0.002);
  EXPECT_EQ(found.T_a_b.translation_m.z(), 0.0);
  EXPECT_EQ(found.T_a_b.rotation.x(), 0.0);
  EXPECT_EQ(found.T_a_b.rotation.y(), 0.0);
}

TEST(AlignClouds, ABareCorridorHoldsNothingAlongItself) {
  Random random(5);
  Cloud a;
  Cloud b;
  for (const Rectangle& side :
       {Rectangle{{0, 0, 0}, {8, 0, 0}, {0, 0, 2.5}}, Rectangle{{0, 2, 0}, {8, 0, 0}, {0, 0, 2.5}},
        Rectangle{{0, 0, 0}, {8, 0, 0}, {0, 2, 0}}, Rectangle{{0, 0, 2.5}, {8, 0, 0}, {0, 2, 0}}}) {
    strew(a, side, 6'000, 0.005, random);
    strew(b, side, 6'000, 0.005, random);
  }
  const Alignment found = align_clouds(a, b, {});
  EXPECT_FALSE(found.is_believed());
  Eigen::Index largest = 0;
  found.weakest.cwiseAbs().maxCoeff(&largest);
  EXPECT_EQ(largest, 0);  // x
}

TEST(AlignClouds, CloudsOfOtherPlacesAreNotBelieved) {
  Cloud far = furnished_room(7);
  for (CloudPoint& point : far) point.x_m += 100.0F;
  EXPECT_FALSE(align_clouds(furnished_room(6), far, {}).is_believed());
}

TEST(AlignClouds, FewPointsAreRefused) { EXPECT_THROW(align_clouds(furnished_room(1), Cloud(99), {}), InputError); }

}  // namespace
}  // namespace gdtslam
