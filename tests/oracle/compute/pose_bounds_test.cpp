// What the sums of pose_bounds mean, against fields made from their definition and the cost of poses drawn from the
// boxes. Frames: cells from the anchor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/random.hpp"
#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::int32_t kBoundsSide = 120;  // of the field, cells
constexpr std::int32_t kAnchor = 51;       // cell
constexpr std::uint32_t kBoundsCap = 255;  // so that cells are bytes as they are
constexpr std::int32_t kMargin = 24;       // columns and rows of planes around the field

/// A scene: noise with deep holes of a cell, its border at the cap, and points.
struct Scene {
  std::vector<std::uint16_t> field;
  std::vector<PointCells> points;

  [[nodiscard]] std::uint16_t at(std::int32_t x, std::int32_t y) const {
    if (x < 0 || y < 0 || x >= kBoundsSide || y >= kBoundsSide) return kBoundsCap;
    return field[static_cast<std::size_t>(y * kBoundsSide + x)];
  }
  [[nodiscard]] PoseCost::Params cost(Interpolation interpolation) const {
    return {.width = kBoundsSide,
            .height = kBoundsSide,
            .stride = kBoundsSide,
            .anchor_x = kAnchor,
            .anchor_y = kAnchor,
            .point_count = static_cast<std::uint32_t>(points.size()),
            .cap = kBoundsCap,
            .interpolation = interpolation};
  }
};

// Sums hide what goes wrong for one point, so most scenes have one or two.
Scene make_scene(std::uint64_t seed) {
  constexpr std::uint32_t kPointCounts[] = {23, 1, 2, 1};
  Random random(seed);
  Scene scene;
  for (std::int32_t y = 0; y < kBoundsSide; ++y) {
    for (std::int32_t x = 0; x < kBoundsSide; ++x) {
      const bool border = x < 2 || y < 2 || x + 2 >= kBoundsSide || y + 2 >= kBoundsSide;
      const std::uint64_t value = random.below(50) == 0 ? random.below(9) : 200 + random.below(56);
      scene.field.push_back(static_cast<std::uint16_t>(border ? kBoundsCap : value));
    }
  }
  for (std::uint32_t i = 0; i < kPointCounts[seed % std::size(kPointCounts)]; ++i) {
    scene.points.push_back(
        {static_cast<float>(random.uniform(-45.0, 45.0)), static_cast<float>(random.uniform(-45.0, 45.0))});
  }
  return scene;
}

/// Samples 2^sample_bits cells apart, 2^phase_bits of them a spacing; `half` cells on each side of a sample count.
struct Sampling {
  std::int32_t sample_bits = 0;
  std::int32_t phase_bits = 0;
  std::int32_t half = 0;

  [[nodiscard]] std::int32_t spacing_cells() const { return 1 << (sample_bits + phase_bits); }
  [[nodiscard]] std::int32_t columns() const { return kBoundsSide / spacing_cells() + 2 * kMargin; }
  /// Column and row of the anchor.
  [[nodiscard]] std::int32_t first() const { return kAnchor / spacing_cells() + kMargin; }
};

std::vector<std::uint8_t> dilated(const Scene& scene, const Sampling& sampling) {
  const std::int32_t phases = 1 << sampling.phase_bits;
  const std::int32_t columns = sampling.columns();
  std::vector<std::uint8_t> samples;
  for (std::int32_t phase = 0; phase < phases * phases; ++phase) {
    for (std::int32_t row = 0; row < columns; ++row) {
      for (std::int32_t column = 0; column < columns; ++column) {
        const std::int32_t u = (column - sampling.first()) * phases + phase % phases;
        const std::int32_t v = (row - sampling.first()) * phases + phase / phases;
        const std::int32_t x = kAnchor + u * (1 << sampling.sample_bits);
        const std::int32_t y = kAnchor + v * (1 << sampling.sample_bits);
        std::uint16_t least = kBoundsCap;
        for (std::int32_t dy = -sampling.half; dy <= sampling.half; ++dy) {
          for (std::int32_t dx = -sampling.half; dx <= sampling.half; ++dx) {
            least = std::min(least, scene.at(x + dx, y + dy));
          }
        }
        samples.push_back(static_cast<std::uint8_t>(least));
      }
    }
  }
  return samples;
}

std::vector<std::uint32_t> sums_of(Isa isa, const Scene& scene, const Sampling& sampling, bool wide,
                                   const PoseCandidate& tile) {
  const PoseBounds::Params params{.width = static_cast<std::uint32_t>(sampling.columns()),
                                  .height = static_cast<std::uint32_t>(sampling.columns()),
                                  .first_column = sampling.first(),
                                  .first_row = sampling.first(),
                                  .phase_bits = static_cast<std::uint32_t>(sampling.phase_bits),
                                  .samples_per_cell = std::ldexp(1.0F, -sampling.sample_bits),
                                  .point_count = static_cast<std::uint32_t>(scene.points.size()),
                                  .tile_width = wide ? 16U : 2U,
                                  .tile_height = wide ? 4U : 2U};
  std::vector<BoundPoint> points;
  for (const PointCells& point : scene.points) points.push_back({point.x, point.y, 0});
  std::vector<std::uint32_t> sums(std::size_t{params.tile_width} * params.tile_height);
  const std::vector<std::uint8_t> samples = dilated(scene, sampling);
  pose_bounds_host(isa, params, samples.data(), points.data(), &tile, 1, sums.data());
  return sums;
}

PoseCandidate drawn_tile(Random& random) {
  return {static_cast<float>(random.uniform(-30.0, 30.0)), static_cast<float>(random.uniform(-30.0, 30.0)),
          static_cast<float>(random.uniform(-3.2, 3.2)), 0};
}

constexpr Sampling kSamplings[] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}, {3, 1, 0}};

// A square that holds half a box, half a sample, what the angle moves a point by and a little for rounding bounds the
// cost of every pose of the box.
TEST(PoseBoundsMeaning, SumsLieBelowTheCostOfEveryPoseOfTheirBox) {
  constexpr double kHalfAngle = 0.02;
  Random random(5);
  double below = 0.0;
  int drawn = 0;
  for (std::uint64_t seed = 1; seed <= 96; ++seed) {
    const Scene scene = make_scene(seed);
    Sampling sampling = kSamplings[seed / 4 % std::size(kSamplings)];
    const double spacing = sampling.spacing_cells();
    double farthest = 0.0;
    for (const PointCells& point : scene.points) {
      farthest = std::max(farthest, static_cast<double>(std::sqrt(point.x * point.x + point.y * point.y)));
    }
    const double far = farthest * kHalfAngle;
    const double half_sample = 0.5 * (1 << sampling.sample_bits);
    sampling.half = static_cast<std::int32_t>(std::ceil(0.5 * spacing + half_sample + far + 0.01));
    const bool wide = seed / 24 % 2 == 0;
    const std::size_t tile_width = wide ? 16 : 2;
    const PoseCandidate tile = drawn_tile(random);
    const std::vector<std::uint32_t> sums = sums_of(best_isa(), scene, sampling, wide, tile);
    for (std::size_t box = 0; box < sums.size(); ++box, ++drawn) {
      const auto within = [&](double centre, double half) {
        return static_cast<float>(centre + std::clamp(random.uniform(-3.0, 3.0), -1.0, 1.0) * half);
      };
      const PoseCandidate pose{
          within(static_cast<double>(tile.x) + static_cast<double>(box % tile_width) * spacing, 0.5 * spacing),
          within(static_cast<double>(tile.y) + static_cast<double>(box / tile_width) * spacing, 0.5 * spacing),
          within(static_cast<double>(tile.theta), kHalfAngle), 0};
      const std::uint32_t cost = brute_pose_cost(scene.cost(Interpolation::kBilinear), scene.field, scene.points, pose);
      ASSERT_LE(sums[box], cost) << "seed " << seed << ", box " << box;
      below += sums[box] > 0 ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(below, drawn / 4.0) << "bounds of 0 hold whatever they are of";
}

// With squares of one cell and samples a cell apart a sum is the cost itself, of nearest cells: an equality, which a
// sample that is off by one would break.
TEST(PoseBoundsMeaning, SumsOfSingleCellsAreTheCost) {
  Random random(6);
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Scene scene = make_scene(seed);
    const Sampling& sampling = kSamplings[seed / 4 % 3];
    const PoseCandidate tile = drawn_tile(random);
    // Positions that the cost rounds into the next cell do not count: it quantises to 1/256 cell.
    const SinCos<double> rotation = sin_cos(static_cast<double>(tile.theta));
    const auto is_inside = [](double position) {
      const double fraction = position - std::floor(position);
      return fraction > 0.004 && fraction < 0.996;
    };
    std::erase_if(scene.points, [&](const PointCells& point) {
      const auto x = static_cast<double>(point.x);
      const auto y = static_cast<double>(point.y);
      return !is_inside(rotation.cos * x - rotation.sin * y + static_cast<double>(tile.x)) ||
             !is_inside(rotation.sin * x + rotation.cos * y + static_cast<double>(tile.y));
    });
    for (const bool wide : {false, true}) {
      for (const Isa isa : available_isas()) {
        const std::vector<std::uint32_t> sums = sums_of(isa, scene, sampling, wide, tile);
        for (std::size_t box = 0; box < sums.size(); ++box, ++compared) {
          const std::size_t tile_width = wide ? 16 : 2;
          const auto spacing = static_cast<float>(sampling.spacing_cells());
          const PoseCandidate pose{tile.x + static_cast<float>(box % tile_width) * spacing,
                                   tile.y + static_cast<float>(box / tile_width) * spacing, tile.theta, 0};
          ASSERT_EQ(sums[box], brute_pose_cost(scene.cost(Interpolation::kNearest), scene.field, scene.points, pose))
              << "seed " << seed << ", box " << box;
        }
      }
    }
  }
  EXPECT_GT(compared, 4000U);
}

}  // namespace
}  // namespace gdtslam::test
