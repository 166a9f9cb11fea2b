// The merge against rows (9) to (11) of docs/paper.md, for every pair of values of a small range and around the limits
// of 16 bits.
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"

#include <gtest/gtest.h>

#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"
#include "support/merge_row.hpp"

namespace gdtslam::test {
namespace {

/// All pairs of the values: the scan's along x, the map's along y.
void expect_all_pairs(const std::vector<std::uint16_t>& values, const GdtMerge::Params& params) {
  std::vector<std::uint16_t> scan;
  std::vector<std::uint16_t> before;
  std::vector<std::uint16_t> expected;
  for (const std::uint16_t global : values) {
    for (const std::uint16_t seen : values) {
      scan.push_back(seen);
      before.push_back(global);
      expected.push_back(brute_merge(params, global, seen));
    }
  }
  for (const Isa isa : available_isas()) {
    const std::vector<std::uint16_t> after = merged(isa, params, before, scan);
    for (std::size_t i = 0; i < after.size(); ++i) {
      ASSERT_EQ(after[i], expected[i]) << "G " << before[i] << " D " << scan[i] << " threshold " << params.threshold
                                       << " lift " << params.lift << ' ' << to_string(isa);
    }
  }
}

std::vector<std::uint16_t> range_of(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint16_t> values;
  for (std::uint32_t i = 0; i < count; ++i) {
    values.push_back(static_cast<std::uint16_t>(first + i));
  }
  return values;
}

TEST(GdtMerge, EveryPairOfValues) {
  for (const MergeRule rule : {MergeRule::kWorking, MergeRule::kLiteral}) {
    for (const std::uint32_t threshold : {0U, 1U, 7U, 200U}) {
      for (const std::uint32_t lift : {0U, threshold / 2, threshold}) {
        expect_all_pairs(range_of(0, 130), {.threshold = threshold, .lift = lift, .cap = 120, .rule = rule});
        expect_all_pairs(range_of(65406, 130), {.threshold = threshold, .lift = lift, .cap = 65535, .rule = rule});
      }
    }
    expect_all_pairs({0, 1, 32767, 32768, 65279, 65280, 65281, 65535},
                     {.threshold = 40000, .lift = 40000, .cap = 65280, .rule = rule});
    expect_all_pairs({0, 1, 32767, 32768, 65279, 65280, 65281, 65535},
                     {.threshold = 4000000000U, .lift = 0, .cap = 65280, .rule = rule});
  }
}

// docs/paper.md, (10) and (11): a new obstacle enters, a wall out of sight stays; as printed it is the other way round.
TEST(GdtMerge, WorkingRuleLetsNewObstaclesInAndLiteralDoesNot) {
  const std::vector<std::uint16_t> scan{0, 2560};  // a new obstacle; a wall of the map that the scan does not see
  GdtMerge::Params params{.threshold = 256, .lift = 128, .cap = 5120};
  const std::vector<std::uint16_t> working = merged(best_isa(), params, {2560, 0}, scan);
  params.rule = MergeRule::kLiteral;
  const std::vector<std::uint16_t> literal = merged(best_isa(), params, {2560, 0}, scan);
  EXPECT_EQ(working[0], 128);
  EXPECT_EQ(working[1], 0);
  EXPECT_EQ(literal[0], 2560);
  EXPECT_EQ(literal[1], 2688);
}

}  // namespace
}  // namespace gdtslam::test
