// Fields that lie in strips: sizes by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "support/address_space.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;

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
