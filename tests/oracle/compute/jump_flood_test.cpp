// Jump flooding, all passes, against an implementation with coordinates and sorted candidates; and its distance from
// the truth.
#include "gdtslam/compute/kernels/jump_flood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "gdtslam/compute/kernels/edt.hpp"
#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr JumpFloodVariant kVariants[] = {JumpFloodVariant::kPlain, JumpFloodVariant::kOnePlus,
                                          JumpFloodVariant::kPlusTwo, JumpFloodVariant::kSquared};

std::vector<std::uint32_t> flooded(Backend& backend, JumpFloodVariant variant, const std::vector<std::uint8_t>& seeds,
                                   const GridShape& shape) {
  const Extent all{shape.width, shape.height, 1};
  Buffer seed_buffer = backend.allocate(seeds.size());
  Buffer nearest = backend.allocate(seeds.size() * 4);
  Buffer next = backend.allocate(seeds.size() * 4);
  backend.upload(seed_buffer, std::as_bytes(std::span(seeds)));
  run<JumpFloodInit>(backend, {shape.width, shape.height, shape.stride}, all, seed_buffer, nearest);
  for (const std::uint32_t step : jump_flood_steps(variant, shape.width, shape.height)) {
    run<JumpFloodStep>(backend, {shape.width, shape.height, shape.stride, step}, all, nearest, next);
    std::swap(nearest, next);
  }
  run<JumpFloodDistance>(backend, {shape.width, shape.height, shape.stride}, all, nearest, next);
  std::vector<std::uint32_t> result(seeds.size());
  backend.download(next, std::as_writable_bytes(std::span(result)));
  return result;
}

TEST(JumpFlood, EveryVariantMatchesTheSlowOne) {
  for (const Isa isa : available_isas()) {
    const auto backend = make_cpu_backend({.threads = 2, .isa = isa});
    for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 6U}, {9U, 1U}, {16U, 16U}, {33U, 20U}, {61U, 67U}}) {
      const GridShape shape{width, height, grid_stride(width)};
      for (const SeedPattern pattern : {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse,
                                        SeedPattern::kChecks, SeedPattern::kWalls, SeedPattern::kAll}) {
        std::vector<std::uint8_t> seeds = make_seeds(pattern, width, height, shape.stride, 5);
        for (const JumpFloodVariant variant : kVariants) {
          const auto expected = brute_jump_flood(variant, seeds, shape);
          const auto found = flooded(*backend, variant, seeds, shape);
          for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
              const std::size_t cell = std::size_t{y} * shape.stride + x;
              ASSERT_EQ(found[cell], expected[cell])
                  << name_of(variant) << ' ' << name_of(pattern) << " at " << x << ", " << y << ' ' << name_of(isa);
            }
          }
        }
      }
    }
  }
}

TEST(JumpFlood, StepsAreThoseOfTheLiterature) {
  using Steps = std::vector<std::uint32_t>;
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kPlain, 8, 5), (Steps{4, 2, 1}));
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kPlain, 3, 9), (Steps{8, 4, 2, 1}));
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kOnePlus, 8, 8), (Steps{1, 4, 2, 1}));
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kPlusTwo, 8, 8), (Steps{4, 2, 1, 2, 1}));
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kSquared, 8, 8), (Steps{4, 2, 1, 4, 2, 1}));
  EXPECT_EQ(jump_flood_steps(JumpFloodVariant::kPlain, 1, 1), Steps{});
}

// [Rong2007] reports that 1+JFA and the like leave far fewer errors than plain JFA.
TEST(JumpFlood, MorePassesLeaveFewerErrorsAndNeverTooSmallADistance) {
  const GridShape shape{256, 256, 256};
  const std::vector<std::uint8_t> seeds = make_seeds(SeedPattern::kSparse, 256, 256, 256, 3);
  const std::vector<std::uint32_t> exact = brute_sq_distances(seeds, shape);
  const auto backend = make_cpu_backend({});
  std::vector<JumpFloodError> errors;
  for (const JumpFloodVariant variant : kVariants) {
    const std::vector<std::uint32_t> found = flooded(*backend, variant, seeds, shape);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      ASSERT_GE(found[i], exact[i]);
    }
    errors.push_back(jump_flood_error(exact, found, {256, 256, 256}));
    EXPECT_EQ(errors.back().cells, 65536U);
    EXPECT_LT(errors.back().wrong_cells, 656U) << name_of(variant);  // under 1 %
    EXPECT_LT(errors.back().largest_cells, 4.0) << name_of(variant);
  }
  EXPECT_GT(errors[0].wrong_cells, 0U);
  EXPECT_LE(errors[1].wrong_cells, errors[0].wrong_cells);
  EXPECT_LE(errors[2].wrong_cells, errors[0].wrong_cells);
  EXPECT_LE(errors[3].wrong_cells, errors[0].wrong_cells);
}

TEST(JumpFloodError, CountsWrongCellsAndTheLargestDistance) {
  const std::vector<std::uint32_t> exact{0, 4, 9, 77, 25, 99};
  const std::vector<std::uint32_t> found{0, 9, 9, 78, 16, 99};  // columns 1 of row 0 and 1 of row 1 are wrong
  const JumpFloodError error = jump_flood_error(exact, found, {3, 2, 3});
  EXPECT_EQ(error.cells, 6U);
  EXPECT_EQ(error.wrong_cells, 3U);
  EXPECT_DOUBLE_EQ(error.largest_cells, 1.0);
  const JumpFloodError inner = jump_flood_error(exact, found, {1, 2, 3});
  EXPECT_EQ(inner.wrong_cells, 1U);
  EXPECT_NEAR(inner.largest_cells, std::sqrt(78.0) - std::sqrt(77.0), 1e-12);
  EXPECT_TRUE(std::isinf(jump_flood_error(exact, {{0, 4, kNoSeed, 77, 25, 99}}, {3, 2, 3}).largest_cells));
}

}  // namespace
}  // namespace gdtslam::test
