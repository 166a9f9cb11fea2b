// The field under points against the cell that a plain floor names, on every instruction set, off the map too.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kWide = 97;
constexpr std::uint32_t kHigh = 61;
constexpr std::uint32_t kRow = 128;

std::uint32_t cell_below(float coordinate, std::int32_t anchor, std::uint32_t size) {
  const double cell = std::floor(static_cast<double>(coordinate)) + anchor;
  return static_cast<std::uint32_t>(std::clamp(cell, 0.0, static_cast<double>(size - 1)));
}

TEST(PointValues, AreThoseOfTheCellsBelowThePoints) {
  Random random(7);
  std::vector<std::uint16_t> field(std::size_t{kRow} * kHigh);
  for (std::uint16_t& cell : field) cell = static_cast<std::uint16_t>(random.bits() >> 48U);
  std::size_t outside = 0;
  for (const std::uint32_t count : {0U, 1U, 7U, 8U, 16U, 17U, 127U, 128U, 129U, 300U}) {
    std::vector<PointCells> points(count);
    for (PointCells& p : points) {
      p = {static_cast<float>(random.uniform(-90.0, 90.0)), static_cast<float>(random.uniform(-90.0, 90.0))};
    }
    if (count > 2) points[1] = {3.0e9F, -3.0e9F};
    const PointValues::Pose pose{.x = 4.25F, .y = -3.5F, .theta = static_cast<float>(random.uniform(-3.0, 3.0))};
    const PoseCost::Params grid{
        .width = kWide, .height = kHigh, .stride = kRow, .anchor_x = 40, .anchor_y = 25, .point_count = count};
    const SinCos<float> r = sin_cos(pose.theta);
    std::vector<std::uint16_t> expected;
    for (const PointCells& p : points) {
      const float u = (r.cos * p.x - r.sin * p.y) + pose.x;
      const float v = (r.sin * p.x + r.cos * p.y) + pose.y;
      const std::uint32_t x = cell_below(u, grid.anchor_x, kWide);
      const std::uint32_t y = cell_below(v, grid.anchor_y, kHigh);
      outside += x == 0 || y == 0 || x == kWide - 1 || y == kHigh - 1 ? 1U : 0U;
      expected.push_back(field[std::size_t{y} * kRow + x]);
    }
    for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
      if (!isa_available(isa)) continue;
      std::vector<std::uint16_t> values(count, 1);
      point_values_host(isa, grid, field.data(), points.data(), pose, values.data());
      EXPECT_EQ(values, expected) << count << " points, " << to_string(isa);
    }
  }
  EXPECT_GT(outside, 50U);
}

}  // namespace
}  // namespace gdtslam
