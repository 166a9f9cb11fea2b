// The cost and the first step of pose_descent against their definition in double, on every instruction set: points on
// and off the map, values within and beyond the width, cells at the cap, any number of points.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <cstring>
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

/// Cost, gradient and curvature by definition.
struct SlopeTerms {
  double cost = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
};

SlopeTerms defined(const SlopeScene& scene, const PolishedPose& pose, const PriorParams& prior, double width) {
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
    const double share = std::fmin(1.0, d / width);
    all.cost += width * width / 1536.0 * (1.0 - std::pow(1.0 - share * share, 3.0));
    if (d >= kSlopeCap) continue;
    const double gx = (1 - fy) * (v10 - v00) + fy * (v11 - v01);
    const double gy = (1 - fx) * (v01 - v00) + fx * (v11 - v10);
    // A turn by dt moves the turned point (x, y) by (-y, x) dt.
    const Eigen::Vector3d slope(gx, gy, gy * static_cast<double>(x) - gx * static_cast<double>(y));
    const double weight = std::pow(1.0 - share * share, 2.0) / 256.0;
    all.gradient += weight * d * slope;
    all.curvature += weight * slope * slope.transpose();
  }
  const Eigen::Vector3d off(static_cast<double>(pose.x) - static_cast<double>(prior.mean_x),
                            static_cast<double>(pose.y) - static_cast<double>(prior.mean_y),
                            static_cast<double>(pose.theta) - static_cast<double>(prior.mean_theta));
  const auto limit = static_cast<double>(prior.limit);
  const double shift = off.head<2>().squaredNorm() * static_cast<double>(prior.weight_xy);
  const double rotation = off[2] * off[2] * static_cast<double>(prior.weight_theta);
  all.cost += std::fmin(shift, limit) + std::fmin(rotation, limit);
  const double w_xy = shift < limit ? 2.0 * static_cast<double>(prior.weight_xy) : 0.0;
  const double w_t = rotation < limit ? 2.0 * static_cast<double>(prior.weight_theta) : 0.0;
  const Eigen::Vector3d weights(w_xy, w_xy, w_t);
  all.gradient += weights.cwiseProduct(off);
  all.curvature += Eigen::Matrix3d(weights.asDiagonal());
  return all;
}

/// A start after one step by definition, and whether that costs less.
struct FirstStep {
  PolishedPose end;
  double cost_before = 0.0;
  double cost_after = 0.0;
};

FirstStep step_by_definition(const SlopeScene& scene, const PolishedPose& start, const PriorParams& prior,
                             double width) {
  const SlopeTerms at = defined(scene, start, prior, width);
  Eigen::Matrix3d damped = at.curvature;
  damped.diagonal() *= 1.0 + 1.0e-4;
  const Eigen::Vector3d step = damped.ldlt().solve(-at.gradient);
  FirstStep first{.end = start, .cost_before = at.cost};
  first.end.x += static_cast<float>(step[0]);
  first.end.y += static_cast<float>(step[1]);
  first.end.theta += static_cast<float>(step[2]);
  first.cost_after = defined(scene, first.end, prior, width).cost;
  return first;
}

PoseDescent::Params one_width(std::size_t points, std::uint32_t blank, const PriorParams& prior, float width) {
  PoseDescent::Params params;
  params.grid = {.width = kSlopeWide,
                 .height = kSlopeHigh,
                 .stride = kSlopeRow,
                 .blank = blank,
                 .anchor_x = kSlopeAnchorX,
                 .anchor_y = kSlopeAnchorY,
                 .point_count = static_cast<std::uint32_t>(points),
                 .cap = kSlopeCap};
  params.prior = prior;
  params.width = width;
  params.last_width = width;
  params.stop_cells = 0.0F;
  params.stop_rad = 0.0F;
  return params;
}

TEST(PoseDescentStep, IsThatOfItsDefinition) {
  Random random(9);
  int taken = 0;
  int undone = 0;
  for (const std::size_t count : {1U, 2U, 63U, 64U, 65U, 127U, 128U, 129U, 300U}) {
    const SlopeScene scene(count, count);
    for (const float width : {300.0F, 1300.0F, 5120.0F}) {
      for (const float limit : {0.01F, 1.0e6F}) {
        const PolishedPose start{static_cast<float>(random.uniform(-6.0, 6.0)),
                                 static_cast<float>(random.uniform(-6.0, 6.0)),
                                 static_cast<float>(random.uniform(-3.0, 3.0))};
        const PriorParams prior{start.x + 0.5F, start.y, start.theta - 0.02F, 40.0F, 9000.0F, limit};
        const FirstStep first = step_by_definition(scene, start, prior, static_cast<double>(width));
        for (const std::uint32_t blank : {0U, 0xA5F3U}) {
          std::vector<std::uint16_t> field = scene.field;
          for (std::uint16_t& cell : field) cell = static_cast<std::uint16_t>(cell ^ blank);
          PoseDescent::Params params = one_width(count, blank, prior, width);
          for (const Isa isa : available_isas()) {
            SCOPED_TRACE(testing::Message() << count << " points, width " << width << ", " << to_string(isa));
            params.max_evaluations = 1;
            PolishedPose pose = start;
            std::vector<std::uint16_t> values(PoseDescent::row_of(static_cast<std::uint32_t>(count)), 1);
            pose_descent_host(isa, params, field.data(), scene.points.data(), &pose, values.data(), 1);
            ASSERT_NEAR(pose.cost, first.cost_before, 2e-4 * first.cost_before + 1.0);
            ASSERT_EQ(pose.x, start.x);
            params.max_evaluations = 2;
            pose = start;
            pose_descent_host(isa, params, field.data(), scene.points.data(), &pose, values.data(), 1);
            if (std::fabs(first.cost_after - first.cost_before) < 1e-3 * first.cost_before) continue;
            const bool is_taken = first.cost_after < first.cost_before;
            (is_taken ? taken : undone) += 1;
            const PolishedPose& expected = is_taken ? first.end : start;
            const double size =
                std::hypot(static_cast<double>(first.end.x - start.x), static_cast<double>(first.end.y - start.y));
            ASSERT_NEAR(pose.x, expected.x, 2e-3 * size + 1e-4);
            ASSERT_NEAR(pose.y, expected.y, 2e-3 * size + 1e-4);
            ASSERT_NEAR(pose.theta, expected.theta, 2e-3 * size + 1e-4);
          }
        }
      }
    }
  }
  EXPECT_GE(taken, 20);
  EXPECT_GE(undone, 20);
}

TEST(PoseDescentBits, AreTheSameOnEveryInstructionSet) {
  Random random(5);
  for (const std::size_t count : {1U, 17U, 64U, 65U, 180U, 361U}) {
    const SlopeScene scene(count + 1, count);
    for (int trial = 0; trial < 30; ++trial) {
      const PolishedPose start{static_cast<float>(random.uniform(-40.0, 40.0)),
                               static_cast<float>(random.uniform(-40.0, 40.0)),
                               static_cast<float>(random.uniform(-3.0, 3.0))};
      PoseDescent::Params params = one_width(count, 0, {start.x, start.y, start.theta, 4.0F, 900.0F, 1.0e6F}, 5120.0F);
      params.last_width = 900.0F;
      params.stop_cells = 0.01F;
      params.stop_rad = 0.0002F;
      PolishedPose expected = start;
      std::vector<std::uint16_t> expected_values(PoseDescent::row_of(static_cast<std::uint32_t>(count)), 1);
      pose_descent_host(Isa::kBaseline, params, scene.field.data(), scene.points.data(), &expected,
                        expected_values.data(), 1);
      for (const Isa isa : available_isas()) {
        PolishedPose pose = start;
        std::vector<std::uint16_t> values(expected_values.size(), 2);
        pose_descent_host(isa, params, scene.field.data(), scene.points.data(), &pose, values.data(), 1);
        ASSERT_EQ(0, std::memcmp(&pose, &expected, sizeof(pose))) << to_string(isa) << " " << count;
        ASSERT_EQ(values, expected_values) << to_string(isa) << " " << count;
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
