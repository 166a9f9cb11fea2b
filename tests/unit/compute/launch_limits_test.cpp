// What the kernels of fields and points refuse, at the limits that their headers state: each at the last value that is
// allowed and at the next one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;

// What the check of a launch says; empty where it is fine.
template <class K>
std::string fault_of(const typename K::Params& params, std::vector<std::size_t> bytes, Extent threads) {
  try {
    check_launch(K::info(), {bytes, std::as_bytes(std::span(&params, 1)), threads});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

constexpr std::size_t kAmple = std::size_t{1} << 34U;

GdtMerge::Params merge() {
  return {.scan_width = 8,
          .scan_height = 5,
          .scan_stride = 8,
          .global_stride = 16,
          .offset_x = 3,
          .offset_y = 2,
          .threshold = 100,
          .lift = 50,
          .cap = 2560};
}

std::string merge_fault(const GdtMerge::Params& params, std::size_t scan_bytes = kAmple) {
  return fault_of<GdtMerge>(params, {kAmple, scan_bytes}, {params.scan_width, params.scan_height, 1});
}

TEST(LaunchLimits, OfAMerge) {
  EXPECT_EQ(merge_fault(merge()), "");
  GdtMerge::Params at = merge();
  at.lift = at.threshold;
  EXPECT_EQ(merge_fault(at), "");
  ++at.lift;
  EXPECT_THAT(merge_fault(at), HasSubstr("the lift exceeds the threshold"));
  at = merge();
  at.cap = 65535;
  EXPECT_EQ(merge_fault(at), "");
  at.cap = 65536;
  EXPECT_THAT(merge_fault(at), HasSubstr("the cap exceeds 16 bits"));
  at = merge();
  at.rule = static_cast<MergeRule>(2);
  EXPECT_THAT(merge_fault(at), HasSubstr("unknown rule"));
  at.rule = MergeRule::kLiteral;
  EXPECT_EQ(merge_fault(at), "");
  for (auto offset : {&GdtMerge::Params::offset_x, &GdtMerge::Params::offset_y}) {
    at = merge();
    at.*offset = std::numeric_limits<std::uint32_t>::max() - 2;
    EXPECT_NE(merge_fault(at), "") << "beyond 32 bits";
  }
  at = merge();
  at.offset_x = 8;  // 8 + 8 cells of a row of 16
  EXPECT_EQ(merge_fault(at), "");
  at.offset_x = 9;
  EXPECT_NE(merge_fault(at), "");
  // 4 rows of 8 and the last one, 2 bytes a cell.
  EXPECT_EQ(merge_fault(merge(), 80), "");
  EXPECT_NE(merge_fault(merge(), 79), "");
  // A plain field: 6 rows of 16 and a last one of 11 cells.
  EXPECT_EQ(fault_of<GdtMerge>(merge(), {214, 80}, {8, 5, 1}), "");
  EXPECT_NE(fault_of<GdtMerge>(merge(), {213, 80}, {8, 5, 1}), "");
  EXPECT_NE(fault_of<GdtMerge>(merge(), {kAmple, kAmple}, {8, 4, 1}), "");
  EXPECT_NE(fault_of<GdtMerge>(merge(), {kAmple, kAmple}, {7, 5, 1}), "");
}

TEST(LaunchLimits, OfAFieldInRowsAre32BitsOfCells) {
  GdtMerge::Params params = merge();
  params.global_stride = 1U << 20U;
  params.offset_x = params.global_stride - params.scan_width;
  params.offset_y = 4096 - params.scan_height;  // 2^12 rows of 2^20 cells
  EXPECT_EQ(merge_fault(params), "");
  ++params.offset_y;
  EXPECT_THAT(merge_fault(params), HasSubstr("more than 2^32 cells"));
}

GdtStamp::Params stamp() {
  return {.tile_count = 2,
          .words = 16,
          .most_obstacles = 3,
          .stride = 64,
          .radius = 10,
          .threshold = 100,
          .lift = 50,
          .cap = 2560};
}

std::string stamp_fault(const GdtStamp::Params& params) {
  return fault_of<GdtStamp>(params, {kAmple, kAmple, kAmple}, {params.tile_count, 1, 1});
}

TEST(LaunchLimits, OfAStamp) {
  EXPECT_EQ(stamp_fault(stamp()), "");
  const auto with = [](auto member, auto value) {
    GdtStamp::Params params = stamp();
    params.*member = static_cast<std::remove_reference_t<decltype(params.*member)>>(value);
    if (std::is_same_v<decltype(member), decltype(&GdtStamp::Params::radius)>) {
      params.cap = params.radius == stamp().radius ? params.cap : 256 * params.radius;
    }
    return stamp_fault(params);
  };
  using P = GdtStamp::Params;
  EXPECT_EQ(with(&P::radius, 1), "");
  EXPECT_EQ(with(&P::radius, 255), "");
  EXPECT_THAT(with(&P::radius, 0), HasSubstr("1 to 255"));
  EXPECT_THAT(with(&P::radius, 256), HasSubstr("1 to 255"));
  EXPECT_EQ(with(&P::stride, 68), "");
  EXPECT_THAT(with(&P::stride, 66), HasSubstr("multiple of 4"));
  P params = stamp();
  params.blank = 65535;
  EXPECT_EQ(stamp_fault(params), "");
  params.blank = 65536;
  EXPECT_THAT(stamp_fault(params), HasSubstr("16 bits"));
  params = stamp();
  params.lift = params.threshold;
  EXPECT_EQ(stamp_fault(params), "");
  ++params.lift;
  EXPECT_THAT(stamp_fault(params), HasSubstr("lift"));
  for (const std::uint32_t cap : {2559U, 2561U}) {
    params = stamp();
    params.cap = cap;
    EXPECT_THAT(stamp_fault(params), HasSubstr("not that of the radius")) << cap;
  }
  params = stamp();
  params.rule = MergeRule::kLiteral;
  EXPECT_EQ(stamp_fault(params), "");
  params.rule = static_cast<MergeRule>(2);
  EXPECT_THAT(stamp_fault(params), HasSubstr("unknown rule"));
  params = stamp();
  params.words = 1U << 28U;
  EXPECT_EQ(stamp_fault(params), "");
  params.words += 4;
  EXPECT_THAT(stamp_fault(params), HasSubstr("2^28"));
  params.words = 18;
  EXPECT_THAT(stamp_fault(params), HasSubstr("does not hold"));
  params.words = 8;  // two tiles of four words
  EXPECT_EQ(stamp_fault(params), "");
  params.words = 4;
  EXPECT_THAT(stamp_fault(params), HasSubstr("does not hold"));
  params = stamp();
  params.most_obstacles = 1U << 17U;
  EXPECT_EQ(stamp_fault(params), "");
  ++params.most_obstacles;
  EXPECT_THAT(stamp_fault(params), HasSubstr("2^17"));
  // A strip's rows have more than its 64 columns; strips are a multiple of 4 cells apart.
  params = stamp();
  params.strip = 68 * 100;
  params.stride = 68;
  EXPECT_EQ(stamp_fault(params), "");
  params.stride = 64;
  EXPECT_THAT(stamp_fault(params), HasSubstr("64 columns"));
  params.stride = 68;
  params.strip += 2;
  EXPECT_THAT(stamp_fault(params), HasSubstr("multiple of 4"));
  // 16 words of 4 bytes; 11 rows of 2 * 10 + 1 values and 32 on either side, rounded up to 88.
  EXPECT_EQ(fault_of<GdtStamp>(stamp(), {kAmple, 64, 88 * 11 * 2}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(stamp(), {kAmple, 63, 88 * 11 * 2}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(stamp(), {kAmple, 64, 88 * 11 * 2 - 1}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(stamp(), {kAmple, kAmple, kAmple}, {1, 1, 1}), "");
}

// A grid of 5 x 3 in rows of 8 cells has 2 * 8 + 5 = 21 of them.
TEST(LaunchLimits, OfDistanceTransforms) {
  for (const std::uint32_t radius : {1U, 255U}) {
    EXPECT_EQ(fault_of<JumpFloodDistance>({5, 3, 8, radius}, {84, 42}, {5, 3, 1}), "") << radius;
  }
  for (const std::uint32_t radius : {0U, 256U}) {
    EXPECT_THAT(fault_of<JumpFloodDistance>({5, 3, 8, radius}, {84, 42}, {5, 3, 1}), HasSubstr("1 to 255")) << radius;
  }
  EXPECT_EQ(fault_of<DistanceField>({5, 3, 8, 101}, {42, 202, 42}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<DistanceField>({5, 3, 8, 101}, {41, 202, 42}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<DistanceField>({5, 3, 8, 101}, {42, 201, 42}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<DistanceField>({5, 3, 8, 101}, {42, 202, 41}, {5, 3, 1}), "");
  EXPECT_THAT(fault_of<DistanceField>({5, 3, 8, 0}, {42, 202, 42}, {5, 3, 1}), HasSubstr("empty"));
  EXPECT_EQ(fault_of<DistanceField>({5, 3, 8, 1}, {42, 2, 42}, {5, 3, 1}), "");
}

TEST(LaunchLimits, OfJumpFlooding) {
  EXPECT_EQ(fault_of<JumpFloodInit>({5, 3, 8}, {21, 84}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<JumpFloodInit>({5, 3, 8}, {20, 84}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<JumpFloodInit>({5, 3, 8}, {21, 83}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<JumpFloodInit>({5, 3, 8}, {21, 84}, {5, 2, 1}), "");
  for (const std::uint32_t step : {1U, 32767U}) {
    EXPECT_EQ(fault_of<JumpFloodStep>({5, 3, 8, step}, {84, 84}, {5, 3, 1}), "") << step;
  }
  for (const std::uint32_t step : {0U, 32768U}) {
    EXPECT_THAT(fault_of<JumpFloodStep>({5, 3, 8, step}, {84, 84}, {5, 3, 1}), HasSubstr("1 to 32767")) << step;
  }
  EXPECT_NE(fault_of<JumpFloodStep>({5, 3, 8, 1}, {83, 84}, {5, 3, 1}), "");
  EXPECT_NE(fault_of<JumpFloodStep>({5, 3, 8, 1}, {84, 83}, {5, 3, 1}), "");
  EXPECT_EQ(fault_of<JumpFloodInit>({32767, 1, 32768}, {kAmple, kAmple}, {32767, 1, 1}), "");
  EXPECT_NE(fault_of<JumpFloodInit>({32768, 1, 32768}, {kAmple, kAmple}, {32768, 1, 1}), "");
  EXPECT_EQ(fault_of<JumpFloodInit>({1, 32767, 4}, {kAmple, kAmple}, {1, 32767, 1}), "");
  EXPECT_NE(fault_of<JumpFloodInit>({1, 32768, 4}, {kAmple, kAmple}, {1, 32768, 1}), "");
}

TEST(LaunchLimits, OfACost) {
  const PoseCost::Params good{.width = 8, .height = 5, .stride = 8, .point_count = 3, .cap = 2560};
  const auto fault = [](const PoseCost::Params& params) {
    return fault_of<PoseCost>(params, {kAmple, kAmple, kAmple, kAmple}, {7, 1, 1});
  };
  EXPECT_EQ(fault(good), "");
  constexpr std::int32_t kFar = 1 << 21;
  for (auto anchor : {&PoseCost::Params::anchor_x, &PoseCost::Params::anchor_y}) {
    for (const std::int32_t sign : {1, -1}) {
      PoseCost::Params params = good;
      params.*anchor = sign * kFar;
      EXPECT_EQ(fault(params), "");
      params.*anchor = sign * (kFar + 1);
      EXPECT_THAT(fault(params), HasSubstr("2^21 cells off"));
    }
  }
  for (auto side : {&PoseCost::Params::width, &PoseCost::Params::height}) {
    PoseCost::Params params = good;
    params.*side = 2;
    EXPECT_EQ(fault(params), "");
    params.*side = 1;
    EXPECT_THAT(fault(params), HasSubstr("2 x 2"));
  }
  PoseCost::Params params = good;
  params.point_count = 65537;
  EXPECT_EQ(fault(params), "");
  params.point_count = 65538;
  EXPECT_THAT(fault(params), HasSubstr("65,537"));
  params = good;
  params.cap = 65535;
  EXPECT_EQ(fault(params), "");
  params.cap = 65536;
  EXPECT_THAT(fault(params), HasSubstr("16 bits"));
  params = good;
  params.interpolation = static_cast<Interpolation>(2);
  EXPECT_THAT(fault(params), HasSubstr("unknown"));
  params = good;
  params.form = static_cast<CostForm>(2);
  EXPECT_THAT(fault(params), HasSubstr("unknown"));
  // 4 rows of 8 cells and a last one; 3 points of 8 bytes; 7 candidates of 16 and costs of 4 bytes.
  EXPECT_EQ(fault_of<PoseCost>(good, {80, 24, 112, 28}, {7, 1, 1}), "");
  for (std::size_t short_one = 0; short_one < 4; ++short_one) {
    std::vector<std::size_t> bytes{80, 24, 112, 28};
    --bytes[short_one];
    EXPECT_NE(fault_of<PoseCost>(good, bytes, {7, 1, 1}), "") << short_one;
  }
  EXPECT_NE(fault_of<PoseCost>(good, {80, 24, 112, 28}, {7, 2, 1}), "");
}

TEST(LaunchLimits, OfPointsOfASweep) {
  const SweepPoints::Params good{.beams = 5, .strips = 2, .directions = 3, .table_bits = 4};
  // 8 bytes a beam, 64 a strip, 2^4 + 1 elevations and three values a direction of 4 bytes, 16 bytes a point.
  const std::vector<std::size_t> enough{40, 128, (17 + 9) * 4, 80};
  EXPECT_EQ(fault_of<SweepPoints>(good, enough, {5, 1, 1}), "");
  for (std::size_t short_one = 0; short_one < 4; ++short_one) {
    std::vector<std::size_t> bytes = enough;
    --bytes[short_one];
    EXPECT_NE(fault_of<SweepPoints>(good, bytes, {5, 1, 1}), "") << short_one;
  }
  EXPECT_NE(fault_of<SweepPoints>(good, enough, {4, 1, 1}), "");
  const auto fault = [](const SweepPoints::Params& params) {
    return fault_of<SweepPoints>(params, {kAmple, kAmple, kAmple, kAmple}, {params.beams, 1, 1});
  };
  SweepPoints::Params params = good;
  params.table_bits = 20;
  EXPECT_EQ(fault(params), "");
  params.table_bits = 21;
  EXPECT_THAT(fault(params), HasSubstr("2^20"));
  params = good;
  params.beams = 1U << 27U;
  EXPECT_EQ(fault(params), "");
  ++params.beams;
  EXPECT_THAT(fault(params), HasSubstr("2^27"));
  params = good;
  params.directions = 1U << 28U;
  EXPECT_EQ(fault(params), "");
  ++params.directions;
  EXPECT_THAT(fault(params), HasSubstr("2^28"));
  for (auto length :
       {&SweepPoints::Params::lever_x_m, &SweepPoints::Params::lever_z_m, &SweepPoints::Params::height_m}) {
    for (const float odd : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      params = good;
      params.*length = odd;
      EXPECT_THAT(fault(params), HasSubstr("not finite"));
    }
  }
  for (auto count : {&SweepPoints::Params::strips, &SweepPoints::Params::directions}) {
    params = good;
    params.*count = 1;
    EXPECT_EQ(fault(params), "");
    params.*count = 0;
    EXPECT_THAT(fault(params), HasSubstr("without"));
    params.beams = 0;
    EXPECT_EQ(fault(params), "");
  }
  params = good;
  params.form = SweepForm::kLiteral;
  EXPECT_EQ(fault(params), "");
  params.form = static_cast<SweepForm>(2);
  EXPECT_THAT(fault(params), HasSubstr("unknown form"));
}

}  // namespace
}  // namespace gdtslam::test
