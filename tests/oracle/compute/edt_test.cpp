// Both passes of the distance transform together, against every cell's distance to every seed.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/random.hpp"
#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr SeedPattern kPatterns[] = {SeedPattern::kNone, SeedPattern::kOne,    SeedPattern::kSparse, SeedPattern::kHalf,
                                     SeedPattern::kAll,  SeedPattern::kChecks, SeedPattern::kCorners};

std::vector<std::uint16_t> transformed(Isa isa, const std::vector<std::uint8_t>& seeds, const GridShape& shape,
                                       std::uint32_t radius) {
  std::vector<std::uint8_t> columns(seeds.size());
  std::vector<std::uint16_t> squares(seeds.size());
  edt_host(isa, {shape.width, shape.height, shape.stride, radius}, seeds.data(), columns.data(), squares.data());
  return squares;
}

void expect_exact(const std::vector<std::uint8_t>& seeds, const GridShape& shape, std::string_view what) {
  const std::vector<std::uint32_t> exact = brute_sq_distances(seeds, shape);
  for (const Isa isa : available_isas()) {
    for (const std::uint32_t radius : {1U, 2U, 7U, 255U}) {
      EXPECT_EQ(transformed(isa, seeds, shape, radius), truncated(exact, radius))
          << what << ' ' << shape.width << 'x' << shape.height << " R" << radius << ' ' << to_string(isa);
    }
  }
}

TEST(Edt, EverySizeUpToFifteenIsExact) {
  for (std::uint32_t height = 0; height <= 15; ++height) {
    for (std::uint32_t width = 0; width <= 15; ++width) {
      const GridShape shape{width, height, width};  // no padding: rows follow each other
      for (const SeedPattern pattern : kPatterns) {
        expect_exact(make_seeds(pattern, width, height, width, width * 16 + height), shape, to_string(pattern));
      }
    }
    if (HasFailure()) {
      return;
    }
  }
}

TEST(Edt, AllPlacementsOfTwoSeedsInARowAreExact) {
  constexpr GridShape kShape{37, 1, 37};
  for (std::uint32_t a = 0; a < kShape.width; ++a) {
    for (std::uint32_t b = a; b < kShape.width; ++b) {
      std::vector<std::uint8_t> seeds(kShape.width, 0);
      seeds[a] = seeds[b] = 1;
      expect_exact(seeds, kShape, "two in a row");
    }
  }
}

/// A cell and its exact squared distance.
struct Sample {
  std::size_t cell;
  std::uint32_t exact;
};

std::vector<Sample> sample(const std::vector<std::uint8_t>& seeds, const GridShape& shape, int count) {
  Random random(7);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<std::uint32_t>(random.below(shape.width));
    const auto y = static_cast<std::uint32_t>(random.below(shape.height));
    samples.push_back({std::size_t{y} * shape.stride + x, brute_sq_distance(seeds, shape, x, y)});
  }
  return samples;
}

void expect_exact_sample(const std::vector<std::uint8_t>& seeds, const GridShape& shape, std::string_view what) {
  const std::vector<Sample> samples = sample(seeds, shape, 60);
  for (const Isa isa : available_isas()) {
    const std::vector<std::uint16_t> near = transformed(isa, seeds, shape, 20);
    const std::vector<std::uint16_t> far = transformed(isa, seeds, shape, 255);
    for (const auto& [cell, exact] : samples) {
      ASSERT_EQ(near[cell], std::min(exact, 400U)) << what << " at " << cell << ' ' << to_string(isa);
      ASSERT_EQ(far[cell], std::min(exact, 65025U)) << what << " at " << cell << ' ' << to_string(isa);
    }
  }
}

TEST(Edt, LargeGridsAreExactWhereSampled) {
  for (const GridShape& shape : {GridShape{64, 64, 64}, GridShape{509, 251, 512}, GridShape{1024, 1024, 1024}}) {
    for (const SeedPattern pattern : {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse, SeedPattern::kHalf,
                                      SeedPattern::kAll, SeedPattern::kCorners, SeedPattern::kWalls}) {
      expect_exact_sample(make_seeds(pattern, shape.width, shape.height, shape.stride, 11), shape, to_string(pattern));
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
