// Windows of candidates worked out by hand, and laws of their minima.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::test {
namespace {

using testing::ElementsAre;

template <class T>
std::vector<T> values_of(Backend& backend, const Buffer& buffer) {
  std::vector<T> values(buffer.bytes() / sizeof(T));
  backend.download(buffer, std::as_writable_bytes(std::span(values)));
  return values;
}

std::vector<PoseCandidate> lattice(const PoseLattice::Params& params) {
  const auto backend = make_cpu_backend({});
  const std::uint32_t count = params.count_xy * params.count_xy * params.count_theta;
  const Buffer candidates = backend->allocate(count * sizeof(PoseCandidate));
  run<PoseLattice>(*backend, params, {count, 1, 1}, candidates);
  return values_of<PoseCandidate>(*backend, candidates);
}

std::vector<std::uint32_t> minima(const LatticeMinima::Params& params, const std::vector<std::uint32_t>& costs) {
  const auto backend = make_cpu_backend({});
  const Buffer cost = backend->allocate(costs.size() * 4);
  const Buffer found = backend->allocate(costs.size() * 4);
  backend->upload(cost, std::as_bytes(std::span(costs)));
  run<LatticeMinima>(*backend, params, {static_cast<std::uint32_t>(costs.size()), 1, 1}, cost, found);
  return values_of<std::uint32_t>(*backend, found);
}

std::vector<std::uint32_t> smallest(const std::vector<std::uint32_t>& list, std::uint32_t wanted) {
  const auto backend = make_cpu_backend({});
  const Buffer values = backend->allocate(list.size() * 4);
  const Buffer picks = backend->allocate(wanted * std::size_t{8});
  backend->upload(values, std::as_bytes(std::span(list)));
  run<SmallestValues>(*backend, {static_cast<std::uint32_t>(list.size()), wanted}, {1, 1, 1}, values, picks);
  return values_of<std::uint32_t>(*backend, picks);
}

TEST(PoseLattice, ThreeByThreeByTwo) {
  PoseLattice::Params params{.centre_x = 10.0F,
                             .centre_y = -4.0F,
                             .centre_theta = 0.5F,
                             .step_cells = 2.0F,
                             .step_rad = 0.25F,
                             .count_xy = 3,
                             .count_theta = 2};
  params.prior = {.mean_x = 10.0F, .mean_y = -4.0F, .mean_theta = 0.5F, .weight_xy = 1.0F, .weight_theta = 32.0F};
  const std::vector<PoseCandidate> found = lattice(params);
  ASSERT_EQ(found.size(), 18U);
  // An odd count has the centre in its middle; an even one has one sample more below it.
  const std::uint32_t square[] = {8, 4, 8, 4, 0, 4, 8, 4, 8};
  for (std::size_t i = 0; i < 18; ++i) {
    EXPECT_EQ(found[i].x, 8.0F + 2.0F * static_cast<float>(i % 3)) << i;
    EXPECT_EQ(found[i].y, -6.0F + 2.0F * static_cast<float>(i / 3 % 3)) << i;
    EXPECT_EQ(found[i].theta, i < 9 ? 0.25F : 0.5F) << i;
    EXPECT_EQ(found[i].bias, square[i % 9] + (i < 9 ? 2U : 0U)) << i;
  }
}

TEST(PoseLattice, EachShareOfThePriorIsCutAtTheLimitAndTheSumTowardsZero) {
  PoseLattice::Params params{.count_xy = 1, .count_theta = 1};
  params.prior = {
      .mean_x = 3.0F, .mean_y = 4.0F, .mean_theta = 1.0F, .weight_xy = 0.5F, .weight_theta = 0.375F, .limit = 100.0F};
  EXPECT_EQ(lattice(params)[0].bias, 12U);  // 12.5 + 0.375
  params.prior.weight_theta = 0.5F;
  EXPECT_EQ(lattice(params)[0].bias, 13U);  // 12.5 + 0.5
  params.prior.weight_theta = 1.0e30F;
  EXPECT_EQ(lattice(params)[0].bias, 112U);  // 12.5 + 100
  params.prior.weight_xy = 3.0e38F;          // overflows
  EXPECT_EQ(lattice(params)[0].bias, 200U);
  params.prior.limit = 1.0e9F;
  EXPECT_EQ(lattice(params)[0].bias, 2000000000U);
}

TEST(LatticeMinima, OfAPlateauTheFirstAndOfTwoBasinsBoth) {
  EXPECT_THAT(minima({3, 1}, {5, 5, 5, 5, 5, 5, 5, 5, 5}),
              ElementsAre(5, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost));
  EXPECT_THAT(minima({3, 1}, {9, 9, 1, 9, 9, 9, 2, 9, 9}),
              ElementsAre(9, kNoCost, 1, kNoCost, kNoCost, kNoCost, 2, kNoCost, kNoCost));  // cell 0: nothing is lower
  EXPECT_THAT(minima({3, 1}, {9, 9, 9, 9, 1, 9, 0, 9, 9}),
              ElementsAre(kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, 0, kNoCost, kNoCost));
  EXPECT_THAT(minima({1, 5}, {3, 2, 2, 4, 0}), ElementsAre(kNoCost, 2, kNoCost, kNoCost, 0));
  EXPECT_THAT(minima({2, 2}, {7, 7, 7, 7, 7, 7, 7, 6}),
              ElementsAre(kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, kNoCost, 6));
}

// The end of a row is no neighbour of the next row's beginning.
TEST(LatticeMinima, RowsDoNotRunIntoEachOther) {
  std::vector<std::uint32_t> costs(5 * 5, 9);
  costs[4] = 1;   // right end of row 0
  costs[10] = 1;  // left end of row 2
  costs[19] = 1;  // right end of row 3
  const std::vector<std::uint32_t> found = minima({5, 1}, costs);
  EXPECT_EQ(found[4], 1U);
  EXPECT_EQ(found[10], 1U);
  EXPECT_EQ(found[19], 1U);
}

TEST(LatticeMinima, TheBestSampleIsAMinimumAndNoTwoAreNeighbours) {
  Random random(11);
  for (int round = 0; round < 50; ++round) {
    const auto n = static_cast<std::uint32_t>(1 + random.below(12));
    const auto turns = static_cast<std::uint32_t>(1 + random.below(6));
    std::vector<std::uint32_t> costs(std::size_t{n} * n * turns);
    for (std::uint32_t& cost : costs) {
      cost = static_cast<std::uint32_t>(random.below(20));
    }
    const std::vector<std::uint32_t> found = minima({n, turns}, costs);
    const auto best = std::min_element(costs.begin(), costs.end());
    EXPECT_EQ(found[static_cast<std::size_t>(best - costs.begin())], *best);
    EXPECT_EQ(smallest(found, 1), (std::vector{*best, static_cast<std::uint32_t>(best - costs.begin())}));
    for (std::size_t i = 0; i + 1 < found.size(); ++i) {
      const bool in_one_row = i / n == (i + 1) / n;
      EXPECT_TRUE(!in_one_row || found[i] == kNoCost || found[i + 1] == kNoCost) << i;
    }
  }
}

TEST(SmallestValues, ByHand) {
  EXPECT_THAT(smallest({5, 3, kNoCost, 3, 1}, 3), ElementsAre(1, 4, 3, 1, 3, 3));
  EXPECT_THAT(smallest({kNoCost, 7}, 3), ElementsAre(7, 1, kNoCost, kNoCost, kNoCost, kNoCost));
  EXPECT_THAT(smallest({kNoCost - 1, 0}, 2), ElementsAre(0, 1, kNoCost - 1, 0));
  EXPECT_THAT(smallest({}, 1), ElementsAre(kNoCost, kNoCost));
}

}  // namespace
}  // namespace gdtslam::test
