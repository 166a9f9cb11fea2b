// Limits of the kernels that their headers state: the last value that is allowed and the next one, the exact sizes of
// buffers and one byte less, and the extent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"
#include "engine/compute/kernels/point_to_line/point_to_line.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kAmple = std::size_t{1} << 34U;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint32_t kMost32 = std::numeric_limits<std::uint32_t>::max();

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

/// The launch is allowed as it is, and not with a buffer that is a byte short or another extent.
template <class K>
void expect_exact(const typename K::Params& params, const std::vector<std::size_t>& bytes, Extent threads) {
  EXPECT_EQ(fault_of<K>(params, bytes, threads), "");
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::size_t> less = bytes;
    --less[i];
    EXPECT_NE(fault_of<K>(params, less, threads), "") << K::info().name << ", buffer " << i;
  }
  EXPECT_NE(fault_of<K>(params, bytes, {threads.x, threads.y + 1, 1}), "") << K::info().name;
}

/// A change of a launch that is allowed, and what is then said; "" where it is allowed still.
template <class K>
struct Limit {
  std::function<void(typename K::Params&)> change;
  const char* fault;
};

template <class K>
void expect_limits(const typename K::Params& good, std::function<Extent(const typename K::Params&)> threads,
                   const std::vector<Limit<K>>& limits) {
  for (std::size_t i = 0; i < limits.size(); ++i) {
    typename K::Params params = good;
    limits[i].change(params);
    const std::string fault =
        fault_of<K>(params, std::vector<std::size_t>(K::kBindings.size(), kAmple), threads(params));
    EXPECT_THAT(fault, HasSubstr(limits[i].fault)) << K::info().name << ", limit " << i;
    EXPECT_EQ(fault.empty(), limits[i].fault[0] == '\0') << K::info().name << ", limit " << i << ": " << fault;
  }
}

TEST(LaunchLimits, OfAMerge) {
  using P = GdtMerge::Params;
  const P good{.scan_width = 8,
               .scan_height = 5,
               .scan_stride = 8,
               .global_stride = 16,
               .offset_x = 3,
               .offset_y = 2,
               .threshold = 100,
               .lift = 50,
               .cap = 2560};
  expect_exact<GdtMerge>(good, {214, 80}, {8, 5, 1});  // 6 rows of 16 and one of 11 cells; 4 rows of 8 and the last one
  const auto far = [](P& params, std::uint32_t beyond) {  // 2^12 rows of 2^20 cells
    params.global_stride = 1U << 20U;
    params.offset_x = params.global_stride - params.scan_width;
    params.offset_y = 4096 - params.scan_height + beyond;
  };
  expect_limits<GdtMerge>(good,
                          [](const P& p) {
                            return Extent{p.scan_width, p.scan_height, 1};
                          },
                          {{[](P& p) { p.lift = p.threshold; }, ""},
                           {[](P& p) { p.lift = p.threshold + 1; }, "the lift exceeds the threshold"},
                           {[](P& p) { p.cap = 65535; }, ""},
                           {[](P& p) { p.cap = 65536; }, "the cap exceeds 16 bits"},
                           {[](P& p) { p.rule = MergeRule::kLiteral; }, ""},
                           {[](P& p) { p.rule = static_cast<MergeRule>(2); }, "unknown rule"},
                           {[](P& p) { p.offset_x = kMost32 - 2; }, "offset is too large"},
                           {[](P& p) { p.offset_y = kMost32 - 2; }, "offset is too large"},
                           {[](P& p) { p.offset_x = 8; }, ""},  // 8 + 8 cells of a row of 16
                           {[](P& p) { p.offset_x = 9; }, "stride 16"},
                           {[&](P& p) { far(p, 0); }, ""},
                           {[&](P& p) { far(p, 1); }, "more than 2^32 cells"}});
}

TEST(LaunchLimits, OfAStamp) {
  using P = GdtStamp::Params;
  const P good{.tile_count = 2,
               .words = 16,
               .most_obstacles = 3,
               .stride = 64,
               .radius = 10,
               .threshold = 100,
               .lift = 50,
               .cap = 2560};
  const auto radius = [](std::uint32_t cells) { return [cells](P& p) { p.cap = 256 * (p.radius = cells); }; };
  expect_limits<GdtStamp>(good,
                          [](const P& p) {
                            return Extent{p.tile_count, 1, 1};
                          },
                          {{radius(1), ""},
                           {radius(255), ""},
                           {radius(0), "1 to 255"},
                           {radius(256), "1 to 255"},
                           {[](P& p) { p.stride = 68; }, ""},
                           {[](P& p) { p.stride = 66; }, "multiple of 4"},
                           {[](P& p) { p.blank = 65535; }, ""},
                           {[](P& p) { p.blank = 65536; }, "16 bits"},
                           {[](P& p) { p.lift = p.threshold; }, ""},
                           {[](P& p) { p.lift = p.threshold + 1; }, "lift"},
                           {[](P& p) { p.cap = 2559; }, "not that of the radius"},
                           {[](P& p) { p.cap = 2561; }, "not that of the radius"},
                           {[](P& p) { p.rule = MergeRule::kLiteral; }, ""},
                           {[](P& p) { p.rule = static_cast<MergeRule>(2); }, "unknown rule"},
                           {[](P& p) { p.words = 1U << 28U; }, ""},
                           {[](P& p) { p.words = (1U << 28U) + 4; }, "2^28"},
                           {[](P& p) { p.words = 18; }, "does not hold"},
                           {[](P& p) { p.words = 8; }, ""},  // two tiles of four words
                           {[](P& p) { p.words = 4; }, "does not hold"},
                           {[](P& p) { p.most_obstacles = 1U << 17U; }, ""},
                           {[](P& p) { p.most_obstacles = (1U << 17U) + 1; }, "2^17"},
                           // A strip's rows have more than its 64 columns; strips are a multiple of 4 cells apart.
                           {[](P& p) { p.strip = 6800, p.stride = 68; }, ""},
                           {[](P& p) { p.strip = 6800, p.stride = 64; }, "64 columns"},
                           {[](P& p) { p.strip = 6802, p.stride = 68; }, "multiple of 4"}});
  // 16 words of 4 bytes; 11 rows of 2 * 10 + 1 values and 32 on either side, rounded up to 88.
  EXPECT_EQ(fault_of<GdtStamp>(good, {kAmple, 64, 88 * 11 * 2}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(good, {kAmple, 63, 88 * 11 * 2}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(good, {kAmple, 64, 88 * 11 * 2 - 1}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<GdtStamp>(good, {kAmple, kAmple, kAmple}, {1, 1, 1}), "");
}

// A pair is 17 words, its sums 11.
TEST(LaunchLimits, OfPointsOnLines) {
  using P = PointToLine::Params;
  const auto fault = [](const P& p) { return fault_of<PointToLine>(p, {kAmple, kAmple, kAmple, kAmple}, {2, 1, 1}); };
  EXPECT_EQ(fault({}), "");
  EXPECT_EQ(fault({.gate_m2 = 0.0F, .per_kernel_m2 = 0.0F}), "");
  EXPECT_NE(fault({.gate_m2 = -1.0F}).find("gate"), std::string::npos);
  EXPECT_NE(fault({.per_kernel_m2 = 2.0e15F}).find("scale"), std::string::npos);
  EXPECT_NE(fault({.least_cosine = std::numeric_limits<float>::infinity()}).find("cosine"), std::string::npos);
  EXPECT_EQ(fault_of<PointToLine>(P{}, {kAmple, kAmple, 136, 88}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<PointToLine>(P{}, {kAmple, kAmple, 135, 88}, {2, 1, 1}), "");
  EXPECT_NE(fault_of<PointToLine>(P{}, {kAmple, kAmple, 136, 87}, {2, 1, 1}), "");
}

// A map of 256 words for the table, 12 for each of 7 distributions and one for each of 30 cubes: 370 words.
TEST(LaunchLimits, OfNormalDistributions) {
  using P = NdtCost::Params;
  const P good{.point_count = 5, .size_x = 2, .size_y = 3, .size_z = 5, .distribution_count = 7};
  expect_exact<NdtCost>(good, {1480, 60, 96, 8}, {2, 1, 1});
  expect_exact<NdtCost>(good, {1480, 60, 48U << 20U, 4U << 20U}, {1U << 20U, 1, 1});
  EXPECT_THAT(fault_of<NdtCost>(good, {kAmple, kAmple, kAmple, kAmple}, {(1U << 20U) + 1, 1, 1}), HasSubstr("poses"));
  expect_limits<NdtCost>(good,
                         [](const P&) {
                           return Extent{2, 1, 1};
                         },
                         {{[](P& p) { p.point_count = 1U << 20U; }, ""},
                          {[](P& p) { p.point_count = (1U << 20U) + 1; }, "points"},
                          {[](P& p) { p.size_x = 1U << 16U; }, ""},
                          {[](P& p) { p.size_x = (1U << 16U) + 1; }, "65,536"},
                          {[](P& p) { p.size_y = (1U << 16U) + 1; }, "65,536"},
                          {[](P& p) { p.size_z = (1U << 16U) + 1, p.size_x = 0; }, "65,536"},
                          {[](P& p) { p.size_x = p.size_y = 1U << 12U, p.size_z = 16; }, ""},
                          {[](P& p) { p.size_x = p.size_y = 1U << 12U, p.size_z = 17; }, "2^28"},
                          {[](P& p) { p.distribution_count = 1U << 24U; }, ""},
                          {[](P& p) { p.distribution_count = (1U << 24U) + 1; }, "2^24"},
                          {[](P& p) { p.origin_x_m = kNaN; }, "not finite"},
                          {[](P& p) { p.origin_y_m = kNaN; }, "not finite"},
                          {[](P& p) { p.origin_z_m = -std::numeric_limits<float>::infinity(); }, "not finite"},
                          {[](P& p) { p.cubes_per_m = 1.0e6F; }, ""},
                          {[](P& p) { p.cubes_per_m = 1.1e6F; }, "per metre"},
                          {[](P& p) { p.cubes_per_m = 0.0F; }, "per metre"},
                          {[](P& p) { p.cubes_per_m = kNaN; }, "per metre"},
                          {[](P& p) { p.steps_per_unit = 1.0e6F; }, ""},
                          {[](P& p) { p.steps_per_unit = 1.1e6F; }, "per unit"},
                          {[](P& p) { p.steps_per_unit = 0.0F; }, "per unit"},
                          {[](P& p) { p.steps_per_unit = kNaN; }, "per unit"}});
}

// A grid of 5 x 3 in rows of 8 cells has 2 * 8 + 5 = 21 of them.
TEST(LaunchLimits, OfDistanceTransforms) {
  expect_exact<JumpFloodInit>({5, 3, 8}, {21, 84}, {5, 3, 1});
  expect_exact<JumpFloodStep>({5, 3, 8, 1}, {84, 84}, {5, 3, 1});
  expect_exact<JumpFloodDistance>({5, 3, 8, 1}, {84, 42}, {5, 3, 1});
  expect_exact<DistanceField>({5, 3, 8, 101}, {42, 202, 42}, {5, 3, 1});
  const auto grid = [](const auto& p) { return Extent{p.width, p.height, 1}; };
  using Init = JumpFloodInit::Params;
  expect_limits<JumpFloodInit>({5, 3, 8}, grid,
                               {{[](Init& p) {
                                   p = {32767, 1, 32768};
                                 },
                                 ""},
                                {[](Init& p) {
                                   p = {32768, 1, 32768};
                                 },
                                 "limit of 32767"},
                                {[](Init& p) {
                                   p = {1, 32767, 4};
                                 },
                                 ""},
                                {[](Init& p) {
                                   p = {1, 32768, 4};
                                 },
                                 "limit of 32767"}});
  using Step = JumpFloodStep::Params;
  expect_limits<JumpFloodStep>({5, 3, 8, 1}, grid,
                               {{[](Step& p) { p.step = 32767; }, ""},
                                {[](Step& p) { p.step = 0; }, "1 to 32767"},
                                {[](Step& p) { p.step = 32768; }, "1 to 32767"}});
  using Distance = JumpFloodDistance::Params;
  expect_limits<JumpFloodDistance>({5, 3, 8, 1}, grid,
                                   {{[](Distance& p) { p.radius = 255; }, ""},
                                    {[](Distance& p) { p.radius = 0; }, "1 to 255"},
                                    {[](Distance& p) { p.radius = 256; }, "1 to 255"}});
  EXPECT_THAT(fault_of<DistanceField>({5, 3, 8, 0}, {42, 202, 42}, {5, 3, 1}), HasSubstr("empty"));
  EXPECT_EQ(fault_of<DistanceField>({5, 3, 8, 1}, {42, 2, 42}, {5, 3, 1}), "");
}

TEST(LaunchLimits, OfACost) {
  using P = PoseCost::Params;
  const P good{.width = 8, .height = 5, .stride = 8, .point_count = 3, .cap = 2560};
  // 4 rows of 8 cells and a last one; 3 points of 8 bytes; 7 candidates of 16 and costs of 4 bytes.
  expect_exact<PoseCost>(good, {80, 24, 112, 28}, {7, 1, 1});
  constexpr std::int32_t kFar = 1 << 21;
  expect_limits<PoseCost>(good,
                          [](const P&) {
                            return Extent{7, 1, 1};
                          },
                          {{[](P& p) { p.anchor_x = kFar, p.anchor_y = -kFar; }, ""},
                           {[](P& p) { p.anchor_x = -kFar, p.anchor_y = kFar; }, ""},
                           {[](P& p) { p.anchor_x = kFar + 1; }, "2^21 cells off"},
                           {[](P& p) { p.anchor_x = -kFar - 1; }, "2^21 cells off"},
                           {[](P& p) { p.anchor_y = kFar + 1; }, "2^21 cells off"},
                           {[](P& p) { p.anchor_y = -kFar - 1; }, "2^21 cells off"},
                           {[](P& p) { p.width = p.height = 2; }, ""},
                           {[](P& p) { p.width = 1; }, "2 x 2"},
                           {[](P& p) { p.height = 1; }, "2 x 2"},
                           {[](P& p) { p.point_count = 65537; }, ""},
                           {[](P& p) { p.point_count = 65538; }, "65,537"},
                           {[](P& p) { p.cap = 65535; }, ""},
                           {[](P& p) { p.cap = 65536; }, "16 bits"},
                           {[](P& p) { p.interpolation = static_cast<Interpolation>(2); }, "unknown"},
                           {[](P& p) { p.form = static_cast<CostForm>(2); }, "unknown"}});
}

TEST(LaunchLimits, OfPointsOfASweep) {
  using P = SweepPoints::Params;
  const P good{.beams = 5, .strips = 2, .directions = 3, .table_bits = 4};
  // 8 bytes a beam, 64 a strip, 2^4 + 1 elevations and three values a direction of 4 bytes, 16 bytes a point.
  expect_exact<SweepPoints>(good, {40, 128, (17 + 9) * 4, 80}, {5, 1, 1});
  expect_limits<SweepPoints>(good,
                             [](const P& p) {
                               return Extent{p.beams, 1, 1};
                             },
                             {{[](P& p) { p.table_bits = 20; }, ""},
                              {[](P& p) { p.table_bits = 21; }, "2^20"},
                              {[](P& p) { p.beams = 1U << 27U; }, ""},
                              {[](P& p) { p.beams = (1U << 27U) + 1; }, "2^27"},
                              {[](P& p) { p.directions = 1U << 28U; }, ""},
                              {[](P& p) { p.directions = (1U << 28U) + 1; }, "2^28"},
                              {[](P& p) { p.lever_x_m = kNaN; }, "not finite"},
                              {[](P& p) { p.lever_z_m = kNaN; }, "not finite"},
                              {[](P& p) { p.height_m = std::numeric_limits<float>::infinity(); }, "not finite"},
                              {[](P& p) { p.strips = p.directions = 1; }, ""},
                              {[](P& p) { p.strips = 0; }, "without"},
                              {[](P& p) { p.directions = 0; }, "without"},
                              {[](P& p) { p.strips = p.directions = p.beams = 0; }, ""},
                              {[](P& p) { p.form = SweepForm::kLiteral; }, ""},
                              {[](P& p) { p.form = static_cast<SweepForm>(2); }, "unknown form"}});
}

}  // namespace
}  // namespace gdtslam::test
