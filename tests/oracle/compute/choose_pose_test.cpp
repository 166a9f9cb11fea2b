// choose_pose where the answer can be said by hand: a field whose value is 100 times its column, points in the middles
// of cells, and priors that count squared cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "gdtslam/compute/backend.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kSide = 64;
constexpr std::uint32_t kMapCap = 5000;  // columns from 50 on are unknown

PolishedPose shifted(float x) {
  PolishedPose pose;
  pose.x = x;
  return pose;
}

/// The verdict, which every instruction set must agree on; point i lies in column columns[i] at pose 0.
MatchVerdict choose(ChoosePose::Params params, const std::vector<int>& columns,
                    const std::vector<PolishedPose>& poses) {
  std::vector<std::uint16_t> field(std::size_t{kSide} * kSide);
  for (std::size_t i = 0; i < field.size(); ++i) {
    field[i] = static_cast<std::uint16_t>(std::min<std::size_t>(kMapCap, 100 * (i % kSide)));
  }
  std::vector<PointCells> points;
  for (const int column : columns) {
    points.push_back({static_cast<float>(column) + 0.5F, 20.5F});
  }
  params.cost.width = params.cost.height = params.cost.stride = kSide;
  params.cost.point_count = static_cast<std::uint32_t>(points.size());
  params.pose_count = static_cast<std::uint32_t>(poses.size());
  params.map_cap = kMapCap;
  std::vector<MatchVerdict> verdicts;
  for (const Isa isa : available_isas()) {
    const auto backend = make_cpu_backend({.threads = 1, .isa = isa});
    const auto uploaded = [&](const auto& values) {
      Buffer buffer = backend->allocate(values.size() * sizeof(values[0]));
      backend->upload(buffer, std::as_bytes(std::span(values)));
      return buffer;
    };
    const Buffer verdict = backend->allocate(sizeof(MatchVerdict));
    run<ChoosePose>(*backend, params, {}, uploaded(field), uploaded(points), uploaded(poses), verdict);
    backend->download(verdict, std::as_writable_bytes(std::span(&verdicts.emplace_back(), 1)));
    using Words = std::array<std::uint32_t, sizeof(MatchVerdict) / sizeof(std::uint32_t)>;
    EXPECT_EQ(std::bit_cast<Words>(verdicts.back()), std::bit_cast<Words>(verdicts.front())) << to_string(isa);
  }
  return verdicts.front();
}

ChoosePose::Params nearest_params() {
  ChoosePose::Params params;
  params.cost.cap = 2000;
  params.cost.interpolation = Interpolation::kNearest;
  params.gate = 500;
  return params;
}

std::vector<int> columns(int first, int last) {
  std::vector<int> list(static_cast<std::size_t>(last - first + 1));
  std::iota(list.begin(), list.end(), first);
  return list;
}

TEST(ChoosePose, CountsTheEvidence) {
  const MatchVerdict verdict = choose(nearest_params(), columns(2, 55), {shifted(0.0F)});
  EXPECT_EQ(verdict.near, 4U);                      // columns 2 to 5
  EXPECT_EQ(verdict.beside, 39U);                   // 11 to 49
  EXPECT_EQ(verdict.known, 48U);                    // 2 to 49
  EXPECT_EQ(verdict.voters, 18U);                   // 2 to 19, below 2000
  EXPECT_EQ(verdict.sum, 100 * 189U + 36 * 2000U);  // 2 to 19, and 36 times the cap
  EXPECT_EQ(verdict.cost, 100 * 189U);              // voters alone
  EXPECT_EQ(verdict.local_cost, verdict.cost);
  EXPECT_EQ(verdict.chosen, 0U);
}

TEST(ChoosePose, CountsTheEvidenceAtThePoseThatIsChosen) {
  PolishedPose better = shifted(-2.0F);
  better.evaluations = 30;
  better.stop = 2;
  PolishedPose local = shifted(0.0F);
  local.evaluations = 12;
  local.stop = 1;
  const MatchVerdict verdict = choose(nearest_params(), columns(4, 9), {local, better});
  EXPECT_EQ(verdict.chosen, 1U);
  EXPECT_EQ(verdict.x, -2.0F);
  EXPECT_EQ(verdict.cost, 100 * (2 + 3 + 4 + 5 + 6 + 7U));
  EXPECT_EQ(verdict.sum, verdict.cost);
  EXPECT_EQ(verdict.local_cost, 100 * (4 + 5 + 6 + 7 + 8 + 9U));
  EXPECT_EQ(verdict.near, 4U);
  EXPECT_EQ(verdict.evaluations, 42U);
  EXPECT_EQ(verdict.stop, 2U);
}

TEST(ChoosePose, IsSuspectBelowTheShareOfOverlapAndNotAtIt) {
  const std::vector<int> half_near{2, 3, 30, 31};  // two near, two that only vote where pose 0 is suspect
  ChoosePose::Params params = nearest_params();
  params.overlap_q16 = 32768;
  EXPECT_EQ(choose(params, half_near, {shifted(0.0F)}).voters, 2U);
  params.overlap_q16 = 32769;
  const MatchVerdict suspect = choose(params, half_near, {shifted(0.0F)});
  EXPECT_EQ(suspect.voters, 4U);
  EXPECT_EQ(suspect.cost, 500 + 2 * 2000U);
}

TEST(ChoosePose, IsSuspectAboveTheShareOfContradictionAndNotAtIt) {
  const std::vector<int> half_beside{2, 3, 30, 31, 55};  // two of the four known ones are beside
  ChoosePose::Params params = nearest_params();
  params.contradiction_q16 = 32768;
  EXPECT_EQ(choose(params, half_beside, {shifted(0.0F)}).voters, 2U);
  params.contradiction_q16 = 32767;
  EXPECT_EQ(choose(params, half_beside, {shifted(0.0F)}).voters, 5U);
}

TEST(ChoosePose, WithoutPointsNothingIsSuspectAndThePriorDecides) {
  ChoosePose::Params params = nearest_params();
  params.overlap_q16 = 65536;
  params.contradiction_q16 = 0;
  params.prior = {.mean_x = 10.0F, .weight_xy = 1.0F};
  const MatchVerdict verdict = choose(params, {}, {shifted(0.0F), shifted(7.0F), shifted(14.0F)});
  EXPECT_EQ(verdict.chosen, 1U);
  EXPECT_EQ(verdict.cost, 9U);
  EXPECT_EQ(verdict.local_cost, 100U);
  EXPECT_EQ(verdict.voters + verdict.known + verdict.near + verdict.beside + verdict.sum, 0U);
}

TEST(ChoosePose, TheFirstOfEqualsWins) {
  const std::vector<PolishedPose> poses{shifted(1.0F), shifted(-1.0F), shifted(-1.0F), shifted(0.0F)};
  EXPECT_EQ(choose(nearest_params(), columns(4, 9), poses).chosen, 1U);
  EXPECT_EQ(choose(nearest_params(), {}, poses).chosen, 0U);
}

// Pose 0 lies 20 cells from the mean, which is not beyond 20, and costs 400; pose 1 lies 30 away and costs 900 before.
TEST(ChoosePose, APoseThatLeapsCostsTheShareOfItThatIsGiven) {
  ChoosePose::Params params;
  params.prior = {.weight_xy = 1.0F};
  params.far_sq_cells = 400.0F;
  params.far_rad = 1.0F;
  const auto cost_with = [&](std::uint32_t leap_q8) {
    params.leap_q8 = leap_q8;
    const MatchVerdict verdict = choose(params, {}, {shifted(20.0F), shifted(30.0F)});
    EXPECT_EQ(verdict.local_cost, 400U);
    return std::pair(verdict.chosen, verdict.cost);
  };
  EXPECT_EQ(cost_with(0), std::pair(0U, 400U));
  EXPECT_EQ(cost_with(113), std::pair(1U, 397U));  // 900 * 113 / 256 = 397.3
  EXPECT_EQ(cost_with(114), std::pair(0U, 400U));  // 400.8 ties with pose 0
  EXPECT_EQ(cost_with(512), std::pair(0U, 400U));
  params.far_sq_cells = 399.0F;  // now pose 0 is far itself, and nobody leaps
  EXPECT_EQ(cost_with(1), std::pair(0U, 400U));
}

TEST(ChoosePose, CostsSaturateBeforeAndBehindTheLeap) {
  ChoosePose::Params params;
  params.prior = {.weight_xy = 1.0e9F, .limit = 1.0e9F};
  params.far_sq_cells = 1.0F;
  params.far_rad = 1.0F;
  params.leap_q8 = 0xFFFFFFFFU;
  PolishedPose first = shifted(0.5F);  // costs 2.5e8 and is not far
  MatchVerdict verdict = choose(params, {}, {first, shifted(3.0F)});
  EXPECT_EQ(verdict.chosen, 0U);
  EXPECT_EQ(verdict.cost, 250000000U);
  params.leap_q8 = 1221679587;  // 1e9 times it is beyond 32 bits by far
  verdict = choose(params, {}, {first, shifted(3.0F)});
  EXPECT_EQ(verdict.chosen, 0U);
  params.prior.weight_xy = 1.0F;  // 900 times it is 2^32 + 2
  verdict = choose(params, {}, {first, shifted(30.0F)});
  EXPECT_EQ(verdict.chosen, 0U);
  params.prior.weight_xy = 1.0e9F;
  params.leap_q8 = 64;  // a quarter of 1e9
  verdict = choose(params, {}, {first, shifted(3.0F)});
  EXPECT_EQ(verdict.chosen, 0U);
  params.leap_q8 = 63;
  verdict = choose(params, {}, {first, shifted(3.0F)});
  EXPECT_EQ(verdict.chosen, 1U);
  EXPECT_EQ(verdict.cost, 246093750U);
}

}  // namespace
}  // namespace gdtslam::test
