// Thinning against a set of cells, neighbours against all distances.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "engine/cloud/neighbours.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

Cloud random_cloud(std::size_t count, double half_side_m, std::uint64_t seed) {
  Random random(seed);
  Cloud cloud(count);
  for (CloudPoint& point : cloud) {
    const auto coordinate = [&] { return static_cast<float>(random.uniform(-half_side_m, half_side_m)); };
    point.x_m = coordinate();
    point.y_m = coordinate();
    point.z_m = coordinate();
    point.scan = static_cast<std::uint32_t>(&point - cloud.data());
  }
  return cloud;
}

Cloud thinned_by_set(const Cloud& cloud, double voxel_m) {
  std::set<std::tuple<double, double, double>> cells;
  Cloud kept;
  for (const CloudPoint& p : cloud) {
    const auto cell = [voxel_m](float x) { return std::floor(static_cast<double>(x) / voxel_m); };
    if (cells.emplace(cell(p.x_m), cell(p.y_m), cell(p.z_m)).second) kept.push_back(p);
  }
  return kept;
}

Cloud thinned(const Cloud& cloud, double voxel_m, std::size_t piece, std::uint64_t max_voxels = 1U << 24U) {
  CloudKeeper keeper;
  VoxelThinning thinning(voxel_m, max_voxels, keeper);
  for (std::size_t k = 0; k < cloud.size(); k += piece) {
    thinning.add(std::span(cloud).subspan(k, std::min(piece, cloud.size() - k)));
  }
  EXPECT_EQ(thinning.kept(), keeper.cloud.size());
  return keeper.cloud;
}

TEST(VoxelThinning, KeepsTheFirstPointOfEachCubeInOrder) {
  for (const double half_side_m : {0.05, 1.0, 30.0, 15000.0}) {
    const Cloud cloud = random_cloud(50000, half_side_m, 3);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{65}, cloud.size()}) {
      EXPECT_EQ(thinned(cloud, 0.02, piece), thinned_by_set(cloud, 0.02)) << half_side_m << " " << piece;
    }
  }
}

TEST(VoxelThinning, EdgesBelongToTheCubeAbove) {
  Cloud cloud;
  for (int k = -200; k <= 200; ++k) {
    for (const float below : {0.0F, -1e-7F, 1e-30F, -1e-30F}) {
      cloud.push_back({.x_m = static_cast<float>(k) * 0.25F + below, .y_m = -0.0F, .z_m = below});
    }
  }
  EXPECT_EQ(thinned(cloud, 0.25, 7), thinned_by_set(cloud, 0.25));
  EXPECT_EQ(thinned(cloud, 0.1, 7), thinned_by_set(cloud, 0.1));
}

TEST(VoxelThinning, AllPointsInOneCubeAndNone) {
  EXPECT_EQ(thinned(Cloud(1000), 1.0, 100).size(), 1U);
  EXPECT_TRUE(thinned({}, 1.0, 100).empty());
}

std::string error_of(const Cloud& cloud, double voxel_m, std::uint64_t max_voxels) {
  try {
    thinned(cloud, voxel_m, 100, max_voxels);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(VoxelThinning, TooManyCubesSayWhatToDo) {
  Cloud cloud(11);
  for (std::size_t k = 0; k < cloud.size(); ++k) cloud[k].x_m = static_cast<float>(k);
  EXPECT_EQ(error_of(cloud, 0.02, 11), "no error");
  EXPECT_EQ(error_of(cloud, 0.02, 10),
            "the cloud fills more than 10 cubes of 0.02 m; raise cloud.voxel, to 0.04 for example, or "
            "cloud.max_megavoxels");
}

TEST(VoxelThinning, PointsTooFarSayHowFar) {
  EXPECT_EQ(error_of({{.x_m = 20971.5F}, {.y_m = -20971.5F}}, 0.02, 10), "no error");
  EXPECT_THAT(error_of({{.z_m = 20971.6F}}, 0.02, 10), HasSubstr("must lie within 20971.52 m; raise cloud.voxel"));
  EXPECT_THAT(error_of({{.z_m = -1e38F}}, 0.02, 10), HasSubstr("a coordinate of the cloud is -"));
  EXPECT_THAT(error_of({{.z_m = std::nanf("")}}, 0.02, 10), HasSubstr("nan"));
  CloudKeeper keeper;
  EXPECT_THROW(VoxelThinning(0.0, 10, keeper), ConfigError);
}

// Whatever lies as close as the last that was found may stand for it.
TEST(Neighbours, AgreeWithAllDistances) {
  Random random(5);
  for (const std::size_t size : {0U, 1U, 2U, 17U, 1000U}) {
    Cloud cloud = random_cloud(size, 1.0, size);
    for (CloudPoint& p : cloud) p.z_m = std::round(p.z_m * 4.0F) / 4.0F;  // ties
    const Neighbours neighbours(cloud);
    for (int k = 0; k < 100; ++k) {
      const Point3 at(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
      std::vector<double> squared;
      for (const CloudPoint& p : cloud) squared.push_back((to_position(p) - at).squaredNorm());
      std::vector<double> sorted = squared;
      std::sort(sorted.begin(), sorted.end());
      const auto closest = neighbours.closest(at, 20);
      ASSERT_EQ(closest.size(), std::min<std::size_t>(20, size));
      for (std::size_t i = 0; i < closest.size(); ++i) EXPECT_NEAR(squared[closest[i]], sorted[i], 1e-14);
      std::vector<std::uint32_t> within;
      for (std::uint32_t i = 0; i < size; ++i) {
        if (squared[i] <= 0.09) within.push_back(i);
      }
      EXPECT_EQ(neighbours.within(at, 0.3), within);
      const auto nearest = neighbours.nearest(at, 0.3);
      EXPECT_EQ(nearest.has_value(), !within.empty());
      if (nearest) {
        EXPECT_NEAR(squared[*nearest], sorted[0], 1e-14);
      }
    }
    EXPECT_TRUE(neighbours.closest(Point3::Zero(), 0).empty());
  }
}

TEST(Neighbours, TheDistanceItselfIsWithin) {
  const Cloud cloud{{.x_m = 1.0F}, {.x_m = 2.0F}, {.x_m = -1.0F}};
  const Neighbours neighbours(cloud);
  EXPECT_EQ(neighbours.within(Point3::Zero(), 1.0), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_TRUE(neighbours.nearest(Point3::Zero(), 1.0).has_value());
}

}  // namespace
}  // namespace gdtslam
