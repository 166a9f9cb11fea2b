// The sums of pose_slope, one by one, against their definition in double: on every instruction set, with points on and
// off the map, values below and above the scale, cells at the cap, and any number of points.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::int32_t kSlopeWide = 71;
constexpr std::int32_t kSlopeHigh = 53;
constexpr std::uint32_t kSlopeRow = 80;
constexpr std::int32_t kSlopeAnchorX = 30;
constexpr std::int32_t kSlopeAnchorY = 22;
constexpr std::uint16_t kSlopeCap = 5120;

struct SlopeScene {
  std::vector<std::uint16_t> field;
  std::vector<PointCells> points;

  explicit SlopeScene(std::uint64_t seed, std::size_t count) {
    Random random(seed);
    field.assign(std::size_t{kSlopeRow} * kSlopeHigh, kSlopeCap);
    for (std::int32_t y = 2; y < kSlopeHigh - 2; ++y) {
      for (std::int32_t x = 2; x < kSlopeWide - 2; ++x) {
        const bool is_far = random.below(8) == 0;
        field[static_cast<std::size_t>(y) * kSlopeRow + static_cast<std::size_t>(x)] =
            is_far ? kSlopeCap : static_cast<std::uint16_t>(random.below(1500));
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back(
          {static_cast<float>(random.uniform(-40.0, 40.0)), static_cast<float>(random.uniform(-40.0, 40.0))});
    }
  }
  // Beyond the edge lies the cap.
  [[nodiscard]] double at(std::int32_t x, std::int32_t y) const {
    if (x < 0 || y < 0 || x >= kSlopeWide || y >= kSlopeHigh) return kSlopeCap;
    return field[static_cast<std::size_t>(y) * kSlopeRow + static_cast<std::size_t>(x)];
  }
};

/// A sum and what it may be off by: the share of all its terms that float32 takes.
struct SlopeTerms {
  std::array<double, PoseSlope::kSums> sums{};
  std::array<double, PoseSlope::kSums> sizes{};
  void add(const std::array<double, PoseSlope::kSums>& terms) {
    for (std::size_t k = 0; k < terms.size(); ++k) {
      sums[k] += terms[k];
      sizes[k] += std::fabs(terms[k]);
    }
  }
};

SlopeTerms defined(const SlopeScene& scene, const PoseSlope::Pose& pose, double scale) {
  SlopeTerms all;
  const SinCos<float> turn = sin_cos(pose.theta);
  for (const PointCells& point : scene.points) {
    const float x = turn.cos * point.x - turn.sin * point.y;
    const float y = turn.sin * point.x + turn.cos * point.y;
    const float u = (x + pose.x) - 0.5F;
    const float v = (y + pose.y) - 0.5F;
    const auto column = static_cast<std::int32_t>(std::floor(u)) + kSlopeAnchorX;
    const auto row = static_cast<std::int32_t>(std::floor(v)) + kSlopeAnchorY;
    const double fx = static_cast<double>(u) - std::floor(static_cast<double>(u));
    const double fy = static_cast<double>(v) - std::floor(static_cast<double>(v));
    const double v00 = scene.at(column, row);
    const double v10 = scene.at(column + 1, row);
    const double v01 = scene.at(column, row + 1);
    const double v11 = scene.at(column + 1, row + 1);
    const double d = (1 - fy) * ((1 - fx) * v00 + fx * v10) + fy * ((1 - fx) * v01 + fx * v11);
    const bool is_flat = d >= kSlopeCap;
    const double gx = is_flat ? 0.0 : (1 - fy) * (v10 - v00) + fy * (v11 - v01);
    const double gy = is_flat ? 0.0 : (1 - fx) * (v01 - v00) + fx * (v11 - v10);
    // A turn by dt moves the turned point (x, y) by (-y, x) dt.
    const double gt = gy * static_cast<double>(x) - gx * static_cast<double>(y);
    const double cost = d < scale ? d * d / (2.0 * scale) : d - 0.5 * scale;
    const double pull = d < scale ? d / scale : 1.0;
    const double weight = 1.0 / std::fmax(d, scale);
    all.add({cost, pull * gx, pull * gy, pull * gt, weight * gx * gx, weight * gx * gy, weight * gx * gt,
             weight * gy * gy, weight * gy * gt, weight * gt * gt});
  }
  return all;
}

TEST(PoseSlopeSums, AreThoseOfTheirDefinition) {
  Random random(9);
  for (const std::size_t count : {1U, 2U, 15U, 16U, 17U, 127U, 128U, 129U, 300U}) {
    const SlopeScene scene(count, count);
    for (const float scale : {1.0F, 256.0F, 1000.0F}) {
      const PoseSlope::Pose pose{static_cast<float>(random.uniform(-6.0, 6.0)),
                                 static_cast<float>(random.uniform(-6.0, 6.0)),
                                 static_cast<float>(random.uniform(-3.0, 3.0))};
      const SlopeTerms expected = defined(scene, pose, static_cast<double>(scale));
      for (const std::uint32_t blank : {0U, 0xA5F3U}) {
        std::vector<std::uint16_t> field = scene.field;
        for (std::uint16_t& cell : field) cell = static_cast<std::uint16_t>(cell ^ blank);
        PoseSlope::Params params{.grid = {}, .scale = scale};
        params.grid = {.width = kSlopeWide,
                       .height = kSlopeHigh,
                       .stride = kSlopeRow,
                       .blank = blank,
                       .anchor_x = kSlopeAnchorX,
                       .anchor_y = kSlopeAnchorY,
                       .point_count = static_cast<std::uint32_t>(count),
                       .cap = kSlopeCap};
        for (const Isa isa : available_isas()) {
          const PoseSlope::Sums sums = pose_slope_host(isa, params, field.data(), scene.points.data(), pose);
          for (std::size_t k = 0; k < sums.size(); ++k) {
            ASSERT_NEAR(sums[k], expected.sums[k], 2e-4 * expected.sizes[k] + 1e-9)
                << "sum " << k << " of " << count << " points, scale " << scale << ", " << to_string(isa);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
