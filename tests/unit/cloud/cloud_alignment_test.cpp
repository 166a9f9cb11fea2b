// NdtMap and align_clouds: sums by hand, motions that are known, scenes that do not hold a cloud.
#include "engine/cloud/cloud_alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>

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

Alignment aligned(const Cloud& a, const Cloud& b, const AlignmentOptions& options) {
  return align_clouds(a, b, options, *make_cpu_backend({}));
}

TEST(NdtMap, HasTheSumsOfTheStepsFromEachCubesCentre) {
  // Steps of 1/1024 of a cube of 1.024 m are millimetres; the cube's centre is at 0.512 m on each axis.
  const Cloud cloud{{.x_m = 0.612F, .y_m = 0.512F, .z_m = 0.212F}, {.x_m = 0.512F, .y_m = 0.712F, .z_m = 0.512F}};
  NdtMap map(1.024);
  map.add(cloud);
  const NdtSums sums = map.sums_at({1.0, 1.0, 1.0});
  EXPECT_EQ(sums.count, 2);
  EXPECT_EQ(sums.sum, (std::array<std::int64_t, 3>{100, 200, -300}));
  EXPECT_EQ(sums.products, (std::array<std::int64_t, 6>{10'000, 0, -30'000, 40'000, 0, 90'000}));
}

TEST(NdtMap, DoesNotDependOnTheOrderOfThePoints) {
  Cloud cloud = furnished_room(1);
  NdtMap map(0.5);
  map.add(cloud);
  std::reverse(cloud.begin(), cloud.end());
  NdtMap reversed(0.5);
  reversed.add(cloud);
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
    const Alignment found = aligned(a, moved(furnished_room(10 + k), inverse(T_a_b)), {});
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
  const Alignment found = aligned(furnished_room(3), b, {.is_planar = true});
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
  const Alignment found = aligned(a, b, {});
  EXPECT_FALSE(found.is_believed());
  Eigen::Index largest = 0;
  found.weakest.cwiseAbs().maxCoeff(&largest);
  EXPECT_EQ(largest, 0);  // x
}

TEST(AlignClouds, CloudsOfOtherPlacesAreNotBelieved) {
  Cloud far = furnished_room(7);
  for (CloudPoint& point : far) point.x_m += 100.0F;
  EXPECT_FALSE(aligned(furnished_room(6), far, {}).is_believed());
}

// A bare room fits as well after half a turn about its middle.
Cloud bare_room(std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (const Rectangle& side : test::room({5.0, 4.0, 2.5})) strew(cloud, side, 4'000, 0.005, random);
  return cloud;
}
const AlignmentStart kHalfTurn{embed(Pose2{5.0, 4.0, 3.14})};

TEST(AlignClouds, APlaceThatFitsAsWellIsARival) {
  const Alignment found = aligned(bare_room(1), bare_room(2), {.starts = {{}, kHalfTurn}});
  ASSERT_TRUE(found.T_a_b_elsewhere.has_value());
  EXPECT_NEAR(found.elsewhere.score(), found.after.score(), 0.01);
  EXPECT_TRUE(found.fits_elsewhere());
  EXPECT_FALSE(found.is_believed());
}

TEST(AlignClouds, AKeptStartStaysAmongPlacesThatFitAsWell) {
  const Alignment found = aligned(bare_room(1), bare_room(2), {.starts = {kHalfTurn, {}}, .is_first_kept = true});
  EXPECT_LT((found.T_a_b.translation_m - Point3(5.0, 4.0, 0.0)).norm(), 0.01);
  EXPECT_FALSE(found.fits_elsewhere());
  EXPECT_TRUE(found.is_believed());
}

TEST(AlignClouds, AKeptStartIsDoubtfulIfAnotherPlaceFitsBetter) {
  const Cloud a = furnished_room(1);
  const Alignment kept = aligned(a, furnished_room(2), {.starts = {kHalfTurn, {}}, .is_first_kept = true});
  EXPECT_TRUE(kept.fits_elsewhere());
  EXPECT_FALSE(kept.is_believed());
  const Alignment free = aligned(a, furnished_room(2), {.starts = {kHalfTurn, {}}});
  EXPECT_LT(free.T_a_b.translation_m.norm(), 0.005);
  EXPECT_TRUE(free.is_believed());
}

TEST(AlignClouds, AnOpenHeightIsFound) {
  const Pose3 T_a_b{{0.2, -0.1, 2.2}, Eigen::Quaterniond::Identity()};
  const Cloud b = moved(furnished_room(2), inverse(T_a_b));
  const Alignment found = aligned(furnished_room(1), b, {.starts = {{.is_height_open = true}}});
  EXPECT_LT((found.T_a_b.translation_m - T_a_b.translation_m).norm(), 0.003);
}

TEST(NdtMap, TwoMapsMergeIntoThatOfAllPoints) {
  const Cloud cloud = furnished_room(3);
  NdtMap whole(0.5);
  whole.add(cloud);
  NdtMap first(0.5);
  NdtMap second(0.5);
  const std::size_t third = cloud.size() / 3;
  first.add(std::span(cloud).first(third));
  second.add(std::span(cloud).subspan(third));
  second.merge(first);
  EXPECT_EQ(second.cubes(), whole.cubes());
  EXPECT_EQ(second.points(), cloud.size());
  EXPECT_THROW(second.merge(NdtMap(0.25)), InputError);
}

TEST(NdtMap, LeavesOutPointsWithoutAPlace) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  NdtMap map(0.001);
  map.add(Cloud{{.x_m = nan}, {.y_m = 2000.0F}, {.z_m = -2000.0F}, {.x_m = std::numeric_limits<float>::infinity()}});
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.points_left_out(), 4U);
  map.add(Cloud{{.x_m = 1048.0F}, {.x_m = -1048.0F}});
  EXPECT_EQ(map.size(), 2U);
}

// A tilted rectangle of 1 m by 2 m in a cube of 4 m: the sample is a grid on it.
TEST(NdtMap, TheSampleOfAPlaneLiesOnIt) {
  Random random(9);
  Cloud cloud;
  const Rectangle tilted{{1.0, 1.0, 1.0}, {0.8, 0.0, 0.6}, {0.0, 2.0, 0.0}};
  strew(cloud, tilted, 20'000, 0.0, random);
  NdtMap map(4.0);
  map.add(cloud);
  const Cloud sample = sample_cloud(map, 0.1);
  EXPECT_EQ(sample.size(), 200U);
  double low = 4.0;
  double high = 0.0;
  for (const CloudPoint& point : sample) {
    const Point3 at(point.x_m, point.y_m, point.z_m);
    EXPECT_NEAR(tilted.normal().dot(at - tilted.corner), 0.0, 0.004);  // steps of the sums are 4 mm
    low = std::min(low, at.y());
    high = std::max(high, at.y());
  }
  EXPECT_NEAR(high - low, 1.9, 0.03);  // from the middle of the first of twenty rows to that of the last
}

TEST(AlignClouds, FewPointsAreRefused) { EXPECT_THROW(aligned(furnished_room(1), Cloud(99), {}), InputError); }

}  // namespace
}  // namespace gdtslam
