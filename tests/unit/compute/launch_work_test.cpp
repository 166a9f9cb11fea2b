// How many elementary steps a launch is said to have, and fields that lie in strips: sizes by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "support/address_space.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;

template <class K>
std::uint64_t steps_of(const typename K::Params& params, Extent threads) {
  return K::info().work({{}, std::as_bytes(std::span(&params, 1)), threads});
}

TEST(LaunchWork, OfGridsIsTheirCells) {
  EXPECT_EQ(steps_of<JumpFloodInit>({.width = 5, .height = 3, .stride = 8}, {5, 3, 1}), 15U);
  EXPECT_EQ(steps_of<DistanceField>({.width = 5, .height = 3, .stride = 8, .table_size = 2}, {5, 3, 1}), 15U);
  EXPECT_EQ(steps_of<DistanceField>({.width = 1U << 20U, .height = 1U << 20U}, {}), std::uint64_t{1} << 40U);
  EXPECT_EQ(steps_of<FieldGrow>({.old_width = 2, .old_height = 2, .width = 8, .height = 5}, {8, 5, 1}), 40U);
  EXPECT_EQ(steps_of<GdtMerge>({.scan_width = 8, .scan_height = 5}, {8, 5, 1}), 40U);
  EXPECT_EQ(steps_of<GdtMerge>({.scan_width = 1U << 20U, .scan_height = 1U << 20U}, {}), std::uint64_t{1} << 40U);
  EXPECT_EQ(steps_of<GdtStamp>({.tile_count = 3}, {3, 1, 1}), 3U * 64 * 64);
  EXPECT_EQ(steps_of<GdtStamp>({.tile_count = 1U << 24U}, {}), std::uint64_t{1} << 36U);
}

TEST(LaunchWork, OfListsIsTheirThings) {
  EXPECT_EQ(steps_of<SeedScatter>({.count = 7, .width = 5, .height = 3, .stride = 8}, {7, 1, 1}), 7U);
  EXPECT_EQ(steps_of<SweepPoints>({.beams = 7, .strips = 2, .directions = 3}, {7, 1, 1}), 7U);
  EXPECT_EQ(steps_of<PoseLattice>({.count_xy = 3, .count_theta = 5}, {45, 1, 1}), 45U);
  EXPECT_EQ(steps_of<LatticeMinima>({.count_xy = 3, .count_theta = 5}, {45, 1, 1}), 45U);
  EXPECT_EQ(steps_of<SmallestValues>({.count = 99, .wanted = 2}, {1, 1, 1}), 99U);
  EXPECT_EQ(steps_of<PoseStarts>({.candidate_count = 50}, {5, 1, 1}), 5U);
}

TEST(LaunchWork, OfPosesIsALookUpForEachPoint) {
  EXPECT_EQ(steps_of<PoseCost>({.point_count = 11}, {7, 1, 1}), 77U);
  EXPECT_EQ(steps_of<PoseCost>({.point_count = 65536}, {1U << 20U, 1, 1}), std::uint64_t{1} << 36U);
  EXPECT_EQ(steps_of<PoseBounds>({.point_count = 11, .tile_width = 16, .tile_height = 4}, {3, 1, 1}), 11U * 64 * 3);
  PoseSimplex::Params simplex{};
  simplex.cost.point_count = 11;
  simplex.max_evaluations = 100;
  EXPECT_EQ(steps_of<PoseSimplex>(simplex, {3, 1, 1}), 3300U);
  ChoosePose::Params choice{};
  choice.cost.point_count = 11;
  choice.pose_count = 3;
  EXPECT_EQ(steps_of<ChoosePose>(choice, {1, 1, 1}), 55U) << "each pose, and what is looked up of the chosen one twice";
}

// 100 columns are two strips of 64; rows of 68 cells, 5 of them, so 340 from strip to strip. The last cell that is
// touched is the 65th of the last row of the second strip: 340 + 4 * 68 + 65 = 677 cells of 2 bytes.
constexpr PoseCost::Params kStrips{
    .width = 100, .height = 5, .stride = 68, .strip = 340, .point_count = 3, .cap = 2560};

std::string strips_fault(const PoseCost::Params& params, std::size_t field_bytes = std::size_t{1} << 40U) {
  const std::vector<std::size_t> bytes{field_bytes, 24, 112, 28};
  try {
    check_launch(PoseCost::info(), {bytes, std::as_bytes(std::span(&params, 1)), {7, 1, 1}});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(FieldInStrips, TakesTheBytesOfItsLastRow) {
  EXPECT_EQ(strips_fault(kStrips, 677 * 2), "");
  EXPECT_NE(strips_fault(kStrips, 677 * 2 - 1), "");
  PoseCost::Params params = kStrips;
  params.width = 128;
  EXPECT_EQ(strips_fault(params, 677 * 2), "");
  params.width = 129;  // a third one
  EXPECT_EQ(strips_fault(params, (677 + 340) * 2), "");
  EXPECT_NE(strips_fault(params, (677 + 340) * 2 - 1), "");
  params.width = 64;  // one alone
  EXPECT_EQ(strips_fault(params, (677 - 340) * 2), "");
  EXPECT_NE(strips_fault(params, (677 - 340) * 2 - 1), "");
}

TEST(FieldInStrips, ItsStridesAreOfWholeQuadsAndApart) {
  const auto with = [](std::uint32_t stride, std::uint32_t strip, std::uint32_t blank = 0) {
    PoseCost::Params params = kStrips;
    params.stride = stride;
    params.strip = strip;
    params.blank = blank;
    return strips_fault(params);
  };
  EXPECT_THAT(with(64, 340), HasSubstr("more than its 64 columns"));
  EXPECT_THAT(with(66, 340), HasSubstr("stride 66"));
  EXPECT_THAT(with(68, 336), HasSubstr("the strips overlap"));
  EXPECT_THAT(with(68, 342), HasSubstr("no multiple of 4"));
  EXPECT_EQ(with(68, 344), "");
  EXPECT_EQ(with(68, 340, 65535), "");
  EXPECT_THAT(with(68, 340, 65536), HasSubstr("the blank exceeds 16 bits"));
  PoseCost::Params plain = kStrips;
  plain.stride = 100;
  plain.strip = PoseCost::Params{}.strip;
  EXPECT_EQ(strips_fault(plain), "") << "no strips";
  plain.blank = 65536;
  EXPECT_THAT(strips_fault(plain), HasSubstr("the blank exceeds 16 bits"));
}

TEST(FieldInStrips, HasAsManyColumnsAsAnyFieldAndNoMoreThan32BitsOfCells) {
  PoseCost::Params params = kStrips;
  params.height = 2;
  params.strip = 136;
  params.width = 1U << 21U;
  EXPECT_EQ(strips_fault(params), "");
  ++params.width;
  EXPECT_THAT(strips_fault(params), HasSubstr("limit"));
  // Two strips 2^32 - 4 cells apart have more cells than that.
  params.width = 100;
  params.strip = std::numeric_limits<std::uint32_t>::max() - 3;
  EXPECT_THAT(strips_fault(params), HasSubstr("more than 2^32 cells"));
  params.strip -= 136;  // 68 of the first row and 65 of the second lie behind its begin: 2^32 - 7 cells
  EXPECT_EQ(strips_fault(params), "");
}

TEST(CpuBackendMemory, ReservedPagesAreZeroAndLikeAnyBuffer) {
  const auto backend = make_cpu_backend({});
  constexpr std::size_t kBytes = std::size_t{1} << 20U;
  const Buffer reserved = backend->reserve(kBytes);
  if (!reserved.valid() && is_address_space_bounded())
    GTEST_SKIP() << "NOTHING WAS TESTED: the address space is bounded, and the backend reserves nothing";
  ASSERT_TRUE(reserved.valid());
  const std::span<std::byte> view = backend->host_view(reserved);
  ASSERT_EQ(view.size(), kBytes);
  EXPECT_TRUE(std::all_of(view.begin(), view.end(), [](std::byte byte) { return byte == std::byte{0}; }));
  backend->fill(reserved, 0x01010101U);
  EXPECT_EQ(view.back(), std::byte{1});
  const Buffer another = backend->allocate(8);
  EXPECT_NE(another.id(), reserved.id());
}

}  // namespace
}  // namespace gdtslam::test
