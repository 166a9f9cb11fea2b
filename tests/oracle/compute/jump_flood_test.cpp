// Jump flooding, all passes, against an implementation with coordinates and sorted candidates; and its distance from
// the truth.
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

std::vector<std::uint16_t> flooded(Backend& backend, std::span<const std::uint32_t> steps, std::uint32_t radius,
                                   const std::vector<std::uint8_t>& seeds, const GridShape& shape) {
  const Extent all{shape.width, shape.height, 1};
  Buffer seed_buffer = backend.allocate(seeds.size());
  Buffer nearest = backend.allocate(seeds.size() * 4);
  Buffer next = backend.allocate(seeds.size() * 4);
  backend.upload(seed_buffer, std::as_bytes(std::span(seeds)));
  run<JumpFloodInit>(backend, {shape.width, shape.height, shape.stride}, all, seed_buffer, nearest);
  for (const std::uint32_t step : steps) {
    run<JumpFloodStep>(backend, {shape.width, shape.height, shape.stride, step}, all, nearest, next);
    std::swap(nearest, next);
  }
  run<JumpFloodDistance>(backend, {shape.width, shape.height, shape.stride, radius}, all, nearest, next);
  std::vector<std::uint16_t> result(seeds.size());
  backend.download(next, std::as_writable_bytes(std::span(result)));
  return result;
}

/// Equal but for the padding.
void expect_equal(const std::vector<std::uint16_t>& found, const std::vector<std::uint16_t>& expected,
                  const GridShape& shape, const std::string& what) {
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    for (std::uint32_t x = 0; x < shape.width; ++x) {
      const std::size_t cell = std::size_t{y} * shape.stride + x;
      ASSERT_EQ(found[cell], expected[cell]) << what << " at " << x << ", " << y;
    }
  }
}

/// Floods of one grid with the steps for a radius.
void expect_floods_of(const std::vector<std::uint8_t>& seeds, const GridShape& shape, Isa isa) {
  const auto backend = make_cpu_backend({.threads = 2, .isa = isa});
  for (const std::uint32_t radius : {1U, 6U, 20U, 255U}) {
    const auto steps = jump_flood_steps_within(radius);
    const auto expected = truncated(brute_jump_flood(steps, seeds, shape), radius);
    expect_equal(flooded(*backend, steps, radius, seeds, shape), expected, shape,
                 "R" + std::to_string(radius) + " " + std::string(to_string(isa)));
  }
}

TEST(JumpFlood, MatchesTheSlowOne) {
  for (const Isa isa : available_isas()) {
    for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 6U}, {9U, 1U}, {16U, 16U}, {33U, 20U}, {61U, 67U}}) {
      const GridShape shape{width, height, grid_stride(width)};
      for (const SeedPattern pattern : {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse,
                                        SeedPattern::kChecks, SeedPattern::kWalls, SeedPattern::kAll}) {
        expect_floods_of(make_seeds(pattern, width, height, shape.stride, 5), shape, isa);
      }
    }
  }
}

TEST(JumpFlood, StepsWithinARadiusReachIt) {
  using Steps = std::vector<std::uint32_t>;
  EXPECT_EQ(jump_flood_steps_within(1), (Steps{1, 1}));
  EXPECT_EQ(jump_flood_steps_within(15), (Steps{1, 8, 4, 2, 1}));
  EXPECT_EQ(jump_flood_steps_within(16), (Steps{1, 16, 8, 4, 2, 1}));
  EXPECT_EQ(jump_flood_steps_within(255), (Steps{1, 128, 64, 32, 16, 8, 4, 2, 1}));
  // One seed, which no other hides: every cell within the radius finds it.
  constexpr GridShape kShape{131, 121, 160};
  std::vector<std::uint8_t> seeds(std::size_t{kShape.stride} * kShape.height, 0);
  seeds[std::size_t{60} * kShape.stride + 65] = 1;
  const std::vector<std::uint32_t> exact = brute_sq_distances(seeds, kShape);
  const auto backend = make_cpu_backend({});
  for (const std::uint32_t radius : {1U, 7U, 20U, 31U, 60U}) {
    const auto steps = jump_flood_steps_within(radius);
    expect_equal(flooded(*backend, steps, radius, seeds, kShape), truncated(exact, radius), kShape,
                 "R" + std::to_string(radius));
  }
}

TEST(JumpFlood, LeavesFewErrorsAndNeverTooSmallADistance) {
  const GridShape shape{256, 256, 256};
  const std::vector<std::uint8_t> seeds = make_seeds(SeedPattern::kSparse, 256, 256, 256, 3);
  const std::vector<std::uint16_t> exact = truncated(brute_sq_distances(seeds, shape), 255);
  const auto backend = make_cpu_backend({});
  const auto found = flooded(*backend, jump_flood_steps_within(255), 255, seeds, shape);
  int wrong = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_GE(found[i], exact[i]);
    ASSERT_LT(std::sqrt(found[i]) - std::sqrt(exact[i]), 4.0);
    wrong += found[i] != exact[i] ? 1 : 0;
  }
  EXPECT_LT(wrong, 656);  // under 1 %
}

}  // namespace
}  // namespace gdtslam::test
