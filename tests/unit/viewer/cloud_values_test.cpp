// What is computed of clouds before anything is drawn: distances, thinning, scales. Oracles: brute force and sorting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "support/cloud_scenes.hpp"
#include "viewer/scene/cloud/cloud_values.hpp"

namespace gdtslam::test {
namespace {

using test::cloud_point;

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

Cloud random_cloud(std::size_t count, Random& random) {
  Cloud cloud;
  test::strew_outliers(cloud, {1.0, -2.0, 0.5}, 3.0, count, random);
  return cloud;
}

float brute_distance(const CloudPoint& point, const Cloud& reference, double most_m) {
  double best = most_m;
  for (const CloudPoint& other : reference) {
    const double dx = static_cast<double>(point.x_m) - static_cast<double>(other.x_m);
    const double dy = static_cast<double>(point.y_m) - static_cast<double>(other.y_m);
    const double dz = static_cast<double>(point.z_m) - static_cast<double>(other.z_m);
    const double distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (distance < best) best = distance;
  }
  return static_cast<float>(best);
}

TEST(CloudDistances, AreThoseOfBruteForce) {
  Random random(3);
  for (const std::size_t count : {0U, 1U, 2U, 11U, 12U, 13U, 25U, 100U, 997U}) {
    Cloud reference = random_cloud(count, random);
    // Ties: half of them lie on a lattice, some twice.
    for (std::size_t k = 0; k < count / 2; ++k) {
      reference[k] = cloud_point({static_cast<double>(k % 5), static_cast<double>(k % 3), static_cast<double>(k % 2)});
    }
    const Cloud cloud = random_cloud(300, random);
    for (const double most_m : {0.3, 1.0, 100.0}) {
      const std::vector<float> distances = distances_to(cloud, reference, most_m);
      ASSERT_EQ(distances.size(), cloud.size());
      for (std::size_t k = 0; k < cloud.size(); ++k) {
        ASSERT_NEAR(distances[k], brute_distance(cloud[k], reference, most_m), 1e-5) << count << " " << k;
      }
    }
  }
}

std::vector<std::uint32_t> all_of(const Cloud& cloud) {
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

ColourScale scale_of(const CloudLook& look, const Cloud& cloud, std::span<const float> distances_m = {}) {
  return colour_scale(look, CloudValues(look.colour, cloud, distances_m), all_of(cloud));
}

Cloud ramp(std::size_t count) {
  Cloud cloud(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = static_cast<float>(k);
    cloud[k] = {.x_m = 0,
                .y_m = 0,
                .z_m = value,
                .elevation_rad = value / 1000.0F,
                .stamp_s = 1e9 + 0.5 * static_cast<double>(k),
                .scan = static_cast<std::uint32_t>(7 + k)};
  }
  return cloud;
}

TEST(ColourScaleOfCloud, EndsAreTheFirstAndLastPercentile) {
  const Cloud cloud = ramp(1001);
  const auto expect = [&](CloudColour colour, double least, double most, const char* unit) {
    const ColourScale scale = scale_of({.colour = colour, .colour_map = {}, .least = {}, .most = {}}, cloud);
    EXPECT_NEAR(scale.least, least, 1e-4) << scale.quantity;
    EXPECT_NEAR(scale.most, most, 1e-4) << scale.quantity;
    EXPECT_EQ(scale.unit, unit);
    EXPECT_NO_THROW(colour_map(scale.colour_map));
  };
  expect(CloudColour::kHeight, 10.0, 990.0, "m");
  expect(CloudColour::kElevation, 0.010 * 180.0 / M_PI, 0.990 * 180.0 / M_PI, "°");
  expect(CloudColour::kTime, 5.0, 495.0, "s");
  expect(CloudColour::kScan, 17.0, 997.0, "");
  std::vector<float> distances(cloud.size());
  for (std::size_t k = 0; k < distances.size(); ++k) distances[k] = 0.5F + static_cast<float>(k) * 0.001F;
  const ColourScale scale =
      scale_of({.colour = CloudColour::kDistance, .colour_map = {}, .least = {}, .most = {}}, cloud, distances);
  EXPECT_EQ(scale.least, 0.0) << "distances begin at none";
  EXPECT_NEAR(scale.most, 0.5 + 0.990, 1e-5);
}

TEST(ColourScaleOfCloud, GivenEndsHoldAndWrongOnesAreSaid) {
  const Cloud cloud = ramp(1001);
  ColourScale scale = scale_of({.colour_map = "ember", .least = -1.0, .most = {}}, cloud);
  EXPECT_EQ(scale.least, -1.0);
  EXPECT_NEAR(scale.most, 990.0, 1e-4);
  EXPECT_EQ(scale.colour_map, "ember");
  scale = scale_of({.colour = CloudColour::kElevation, .colour_map = {}, .least = 0.0, .most = 0.5}, cloud);
  EXPECT_NEAR(scale.most, 0.5 * 180.0 / M_PI, 1e-9) << "given in radians, shown in degrees";
  EXPECT_THROW(scale_of({.colour_map = {}, .least = 3.0, .most = 1.0}, cloud), ConfigError);
  EXPECT_THROW(scale_of({.colour_map = {}, .least = 3.0, .most = 3.0}, cloud), ConfigError);
  EXPECT_THROW(scale_of({.colour_map = "no-such-map", .least = {}, .most = {}}, cloud), ConfigError);
}

TEST(ColourScaleOfCloud, OneValueOrNoneStillGivesAScale) {
  const Cloud flat(20, cloud_point({1.0, 2.0, 3.0}));
  const ColourScale scale = scale_of({.colour_map = {}, .least = {}, .most = {}}, flat);
  EXPECT_EQ(scale.least, 2.5);
  EXPECT_EQ(scale.most, 3.5);
  const std::vector<float> none_away(flat.size(), 0.0F);
  const ColourScale distances =
      scale_of({.colour = CloudColour::kDistance, .colour_map = {}, .least = {}, .most = {}}, flat, none_away);
  EXPECT_EQ(distances.least, 0.0) << "no distance is negative";
  EXPECT_EQ(distances.most, 1.0);
  const std::vector<float> nothing(flat.size(), kNoNumber);
  const ColourScale none =
      scale_of({.colour = CloudColour::kDistance, .colour_map = {}, .least = {}, .most = {}}, flat, nothing);
  EXPECT_LT(none.least, none.most);
  EXPECT_EQ(colour_at(none, colour_map(none.colour_map), kNoNumber), colour_map(none.colour_map).unknown());
}

TEST(CloudDensity, SpacingOnALatticeIsItsStep) {
  Cloud cloud;
  for (int x = 0; x < 100; ++x) {
    for (int y = 0; y < 100; ++y) cloud.push_back(cloud_point({0.02 * x + 0.01, 0.02 * y + 0.01, 0.05}));
  }
  const CloudDensity density(cloud, all_of(cloud), 0.1);
  for (const CloudPoint& point : cloud) ASSERT_NEAR(density.spacing_m(point), 0.02, 0.003);
  const Cloud alone{cloud_point({500.0, -3.0, 2.0})};
  EXPECT_FLOAT_EQ(CloudDensity(alone, all_of(alone), 0.1).spacing_m(alone[0]), 0.1F);
}

// A square of 10 x 10 m with a million points, in pieces of any size.
class PointLimitTest : public testing::TestWithParam<bool> {};

TEST_P(PointLimitTest, KeepsAsManyAsAskedForAndEvenly) {
  const bool is_expected = GetParam();
  Random random(3);
  Cloud cloud(200'000);
  for (CloudPoint& point : cloud) {
    point.x_m = static_cast<float>(random.uniform(0.0, 10.0));
    point.y_m = static_cast<float>(random.uniform(0.0, 10.0));
  }
  cloud[17].x_m = cloud[199'000].x_m = kNoNumber;
  constexpr std::size_t kMost = 20'000;
  PointLimit thinning(kMost);
  if (is_expected) thinning.expect(cloud.size());
  for (std::size_t at = 0; at < cloud.size();) {
    const std::size_t count = std::min<std::size_t>(1 + random.below(9000), cloud.size() - at);
    thinning.add(std::span(cloud).subspan(at, count));
    at += count;
  }
  const Cloud kept = thinning.take();
  EXPECT_LE(kept.size(), kMost);
  EXPECT_GE(kept.size(), kMost / 4);
  std::array<int, 100> of_square_metre{};
  for (const CloudPoint& point : kept) {
    ++of_square_metre.at(10 * static_cast<std::size_t>(point.y_m) + static_cast<std::size_t>(point.x_m));
  }
  const auto [fewest, most] = std::minmax_element(of_square_metre.begin(), of_square_metre.end());
  EXPECT_GT(*fewest, 0.8 * *most);  // as dense everywhere
}

INSTANTIATE_TEST_SUITE_P(Expected, PointLimitTest, testing::Bool());

// Two centimetres with many points, then points as far as a picture has them: as fine as those allow.
TEST(PointLimit, CoarsensForPointsThatComeFromFarAway) {
  Random random(4);
  Cloud dense(1000);
  for (CloudPoint& point : dense) {
    point.x_m = static_cast<float>(random.uniform(0.0, 0.02));
    point.y_m = static_cast<float>(random.uniform(0.0, 0.02));
  }
  PointLimit thinning(100);
  thinning.add(dense);
  for (const float far_m : {2000.0F, 2100.0F, -5000.0F, 5100.0F, -70'000.0F, 999'000.0F, 1'000'000.0F}) {
    const Cloud one{{.x_m = 0.0F, .y_m = far_m}};
    thinning.add(one);
  }
  const Cloud kept = thinning.take();
  EXPECT_THAT(kept, ::testing::Contains(CloudPoint{.y_m = -5000.0F}));
  EXPECT_THAT(kept, ::testing::Contains(CloudPoint{.y_m = -70'000.0F}));
  EXPECT_EQ(kept.back(), CloudPoint{.y_m = 1'000'000.0F});
  EXPECT_LE(kept.size(), 8U);  // voxels of a metre at the end, the two centimetres in one of them
}

}  // namespace
}  // namespace gdtslam::test
