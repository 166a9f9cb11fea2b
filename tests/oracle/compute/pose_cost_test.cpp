// Positions that are no positions: NaN, infinities, the limits of the clamp, halves of 1/256 cell. The field here has
// no border of caps, so it shows where each one lands.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/random.hpp"
#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Coordinates in cells.
std::vector<float> odd_coordinates() {
  std::vector<float> values{kNaN, -kNaN, kInfinity, -kInfinity, 3.4e38F, -3.4e38F, 0.0F, -0.0F, 1e-40F, -1e-40F};
  for (const float limit : {4194304.0F, 8388608.0F, 2147483648.0F, 4294967296.0F, 1e20F}) {
    for (const float value : {limit, std::nextafter(limit, 0.0F), std::nextafter(limit, 1e30F)}) {
      values.insert(values.end(), {value, -value});
    }
  }
  for (int i = -40; i <= 40; ++i) {  // multiples of 1/512 cell: every second one is a tie
    values.push_back(static_cast<float>(i) / 512.0F);
    values.push_back(std::nextafter(static_cast<float>(i) / 512.0F, 1.0F));
  }
  return values;
}

std::vector<PointCells> all_pairs(const std::vector<float>& values) {
  std::vector<PointCells> points;
  for (const float x : values) {
    for (const float y : {0.25F, kNaN, -kInfinity, 2.0e9F, x}) {
      points.push_back({x, y});
      points.push_back({y, x});
    }
  }
  return points;
}

TEST(PoseCost, OddPositionsLandWhereTheHeaderSays) {
  constexpr std::uint32_t kCostSide = 41;
  std::vector<std::uint16_t> field(std::size_t{kCostSide} * kCostSide);
  Random random(3);
  for (std::uint16_t& value : field) {
    value = static_cast<std::uint16_t>(random.below(65536));
  }
  const std::vector<PointCells> points = all_pairs(odd_coordinates());
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    const PoseCost::Params params{.width = kCostSide,
                                  .height = kCostSide,
                                  .stride = kCostSide,
                                  .anchor_x = 20,
                                  .anchor_y = 19,
                                  .point_count = 1,
                                  .cap = 65535,
                                  .interpolation = interpolation,
                                  .form = CostForm::kDistance};
    for (const PointCells& point : points) {
      for (const float theta : {0.0F, 0.7F, kNaN}) {
        const PoseCandidate pose{0.0F, 0.0F, theta, 0};
        const std::uint32_t expected = brute_pose_cost(params, field, {point}, pose);
        for (const Isa isa : available_isas()) {
          std::uint32_t cost = 0;
          pose_cost_host(isa, params, field.data(), &point, &pose, 1, &cost);
          ASSERT_EQ(cost, expected) << point.x << ", " << point.y << " theta " << theta << ' ' << to_string(isa);
        }
      }
    }
  }
}

// By hand: cell values on a plane come back from the plane itself, at the centres and between them.
TEST(PoseCost, BilinearReproducesAPlane) {
  constexpr std::uint32_t kCostSide = 32;
  std::vector<std::uint16_t> field;
  for (std::uint32_t y = 0; y < kCostSide; ++y) {
    for (std::uint32_t x = 0; x < kCostSide; ++x) {
      field.push_back(static_cast<std::uint16_t>(1000 + 256 * x + 512 * y));
    }
  }
  const PoseCost::Params params{.width = kCostSide,
                                .height = kCostSide,
                                .stride = kCostSide,
                                .anchor_x = 10,
                                .anchor_y = 10,
                                .point_count = 1,
                                .cap = 65535,
                                .interpolation = Interpolation::kBilinear,
                                .form = CostForm::kDistance};
  const PoseCandidate pose{};
  for (const Isa isa : available_isas()) {
    for (int i = -300; i < 300; i += 7) {
      for (int j = -300; j < 300; j += 11) {  // position (10 + i/256, 10 + j/256); a centre lies at + 1/2
        const PointCells point{static_cast<float>(i) / 256.0F, static_cast<float>(j) / 256.0F};
        std::uint32_t cost = 0;
        pose_cost_host(isa, params, field.data(), &point, &pose, 1, &cost);
        ASSERT_EQ(cost, static_cast<std::uint32_t>(1000 + (2560 + i - 128) + 2 * (2560 + j - 128))) << i << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
