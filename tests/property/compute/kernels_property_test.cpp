// Laws that hold for any input, on random ones.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"
#include "support/merge_row.hpp"

namespace gdtslam::test {
namespace {

Isa random_isa() { return *rc::gen::elementOf(available_isas()); }

/// A field, points and poses for pose_cost.
struct CostProblem {
  PoseCost::Params params;
  std::vector<std::uint16_t> field;
  std::vector<PointCells> points;
  PoseCandidate pose;
};

CostProblem random_problem() {
  CostProblem problem;
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  PoseCost::Params& params = problem.params;
  params.width = params.stride = static_cast<std::uint32_t>(5 + random.below(120));
  params.height = static_cast<std::uint32_t>(5 + random.below(120));
  params.anchor_x = static_cast<std::int32_t>(random.below(60));
  params.anchor_y = static_cast<std::int32_t>(random.below(60));
  params.cap = static_cast<std::uint32_t>(1 + random.below(65535));
  params.interpolation = random.below(2) == 0 ? Interpolation::kBilinear : Interpolation::kNearest;
  params.form = random.below(2) == 0 ? CostForm::kDistance : CostForm::kSquared;
  for (std::uint32_t y = 0; y < params.height; ++y) {
    for (std::uint32_t x = 0; x < params.width; ++x) {
      const bool border = x < 2 || y < 2 || x + 2 >= params.width || y + 2 >= params.height;
      problem.field.push_back(static_cast<std::uint16_t>(border ? params.cap : random.below(params.cap + 1)));
    }
  }
  problem.points.resize(random.below(300));
  for (PointCells& point : problem.points) {
    point = {static_cast<float>(random.uniform(-60.0, 60.0)), static_cast<float>(random.uniform(-60.0, 60.0))};
  }
  params.point_count = static_cast<std::uint32_t>(problem.points.size());
  problem.pose = {static_cast<float>(random.uniform(-20.0, 20.0)), static_cast<float>(random.uniform(-20.0, 20.0)),
                  static_cast<float>(random.uniform(-3.2, 3.2)), 0};
  return problem;
}

std::uint32_t cost_of(Isa isa, const CostProblem& problem) {
  std::uint32_t cost = 0;
  PoseCost::Params params = problem.params;
  params.point_count = static_cast<std::uint32_t>(problem.points.size());
  pose_cost_host(isa, params, problem.field.data(), problem.points.data(), &problem.pose, 1, &cost);
  return cost;
}

RC_GTEST_PROP(PoseCost, EveryInstructionSetGivesTheSameSum, ()) {
  const CostProblem problem = random_problem();
  const std::uint32_t expected = cost_of(Isa::kBaseline, problem);
  for (const Isa isa : available_isas()) {
    RC_ASSERT(cost_of(isa, problem) == expected);
  }
}

RC_GTEST_PROP(PoseCost, TheOrderOfThePointsDoesNotMatter, ()) {
  CostProblem problem = random_problem();
  const Isa isa = random_isa();
  const std::uint32_t expected = cost_of(isa, problem);
  std::reverse(problem.points.begin(), problem.points.end());
  std::rotate(problem.points.begin(), problem.points.begin() + static_cast<std::ptrdiff_t>(problem.points.size() / 3),
              problem.points.end());
  RC_ASSERT(cost_of(isa, problem) == expected);
}

RC_GTEST_PROP(PoseCost, SumsOfPartsAddUp, ()) {
  const CostProblem problem = random_problem();
  const Isa isa = random_isa();
  CostProblem first = problem;
  CostProblem second = problem;
  const auto cut = static_cast<std::ptrdiff_t>(*rc::gen::inRange<std::size_t>(0, problem.points.size() + 1));
  first.points.assign(problem.points.begin(), problem.points.begin() + cut);
  second.points.assign(problem.points.begin() + cut, problem.points.end());
  RC_ASSERT(cost_of(isa, first) + cost_of(isa, second) == cost_of(isa, problem));
}

RC_GTEST_PROP(PoseCost, ACoordinateThatIsNoNumberCostsTheCap, ()) {
  CostProblem problem = random_problem();
  const Isa isa = random_isa();
  const float odd = *rc::gen::element(std::nanf(""), HUGE_VALF, -HUGE_VALF, 3.0e38F, -3.0e38F);
  const std::uint32_t without = cost_of(isa, problem);
  problem.points.insert(problem.points.begin() + static_cast<std::ptrdiff_t>(problem.points.size() / 2), {odd, 0.0F});
  CostProblem alone = problem;
  alone.points = {{HUGE_VALF, HUGE_VALF}};  // off the map, where the border holds the cap
  RC_ASSERT(cost_of(isa, problem) == without + cost_of(isa, alone));
}

RC_GTEST_PROP(PoseCost, MovingTheAnchorAndThePoseTogetherChangesNothing, ()) {
  CostProblem problem = random_problem();
  const Isa isa = random_isa();
  for (PointCells& point : problem.points) {  // multiples of 1/4 cell, no rotation: sums are exact in float32
    point = {std::floor(point.x * 4.0F) / 4.0F, std::floor(point.y * 4.0F) / 4.0F};
  }
  problem.pose = {std::floor(problem.pose.x), std::floor(problem.pose.y), 0.0F, 0};
  const std::uint32_t expected = cost_of(isa, problem);
  problem.pose.x += 13.0F;
  problem.params.anchor_x -= 13;
  problem.pose.y -= 5.0F;
  problem.params.anchor_y += 5;
  RC_ASSERT(cost_of(isa, problem) == expected);
}

RC_GTEST_PROP(PoseCost, TheBiasIsAddedAndSaturates, ()) {
  CostProblem problem = random_problem();
  const Isa isa = random_isa();
  const std::uint64_t plain = cost_of(isa, problem);
  problem.pose.bias = *rc::gen::oneOf(rc::gen::arbitrary<std::uint32_t>(), rc::gen::just(0xFFFFFFFFU));
  RC_ASSERT(cost_of(isa, problem) == std::min<std::uint64_t>(plain + problem.pose.bias, 0xFFFFFFFFU));
}

RC_GTEST_PROP(GdtMerge, MergingAScanIntoItselfOrIntoNothingGivesTheScan, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const auto count = static_cast<std::uint32_t>(1 + random.below(300));
  GdtMerge::Params params;
  params.cap = 5120;
  params.threshold = static_cast<std::uint32_t>(random.below(600));
  params.lift = params.threshold / 2;
  params.rule = random.below(2) == 0 ? MergeRule::kWorking : MergeRule::kLiteral;
  std::vector<std::uint16_t> scan(count);
  for (std::uint16_t& value : scan) {
    value = static_cast<std::uint16_t>(random.below(params.cap + 1));
  }
  const Isa isa = random_isa();
  RC_ASSERT(merged(isa, params, scan, scan) == scan);
  RC_ASSERT(merged(isa, params, std::vector(count, static_cast<std::uint16_t>(params.cap)), scan) == scan);
}

RC_GTEST_PROP(GdtMerge, ASecondLookConfirmsWhatTheFirstLifted, ()) {
  const auto threshold = *rc::gen::inRange<std::uint32_t>(0, 1000);
  const auto lift = *rc::gen::inRange<std::uint32_t>(0, threshold + 1);
  const auto seen = *rc::gen::inRange<std::uint16_t>(0, 2000);
  GdtMerge::Params params;
  params.cap = 5120;
  params.threshold = threshold;
  params.lift = lift;
  const auto first = static_cast<std::uint16_t>(seen + threshold + 1 + *rc::gen::inRange<std::uint32_t>(0, 1000));
  std::vector<std::uint16_t> map = merged(random_isa(), params, {first}, {seen});
  RC_ASSERT(map.front() == seen + lift);  // (11), tentative
  map = merged(random_isa(), params, map, {seen});
  RC_ASSERT(map.front() == seen + lift / 2);  // (9), halfway
}

}  // namespace
}  // namespace gdtslam::test
