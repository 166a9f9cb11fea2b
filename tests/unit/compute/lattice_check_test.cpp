// What the kernels of the lattice, the seeds and the growth refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A launch as its check sees it: parameters, sizes of the buffers, extent.
template <class K>
void check(const typename K::Params& params, std::vector<std::size_t> bytes, Extent threads) {
  check_launch(K::info(), {bytes, std::as_bytes(std::span(&params, 1)), threads});
}

template <class Change>
void expect_lattice_refused(const char* message, Change change) {
  PoseLattice::Params params{.count_xy = 3, .count_theta = 5};
  change(params);
  EXPECT_THAT(([&] { check<PoseLattice>(params, {45 * 16}, {45, 1, 1}); }), ThrowsMessage<Error>(HasSubstr(message)));
}

TEST(PoseLatticeCheck, TakesWhatItPromises) {
  PoseLattice::Params params{.count_xy = 3, .count_theta = 5};
  EXPECT_NO_THROW(check<PoseLattice>(params, {45 * 16}, {45, 1, 1}));
  params.step_cells = -1.0F;
  params.prior.weight_xy = std::numeric_limits<float>::max();
  params.prior.limit = 0.0F;
  EXPECT_NO_THROW(check<PoseLattice>(params, {45 * 16}, {45, 1, 1}));
}

TEST(PoseLatticeCheck, RefusesNumbersThatAreNone) {
  for (const float odd : {kNaN, kInfinity, -kInfinity}) {
    expect_lattice_refused("not finite", [=](auto& p) { p.centre_x = odd; });
    expect_lattice_refused("not finite", [=](auto& p) { p.centre_y = odd; });
    expect_lattice_refused("not finite", [=](auto& p) { p.centre_theta = odd; });
    expect_lattice_refused("not finite", [=](auto& p) { p.step_cells = odd; });
    expect_lattice_refused("not finite", [=](auto& p) { p.step_rad = odd; });
    expect_lattice_refused("mean", [=](auto& p) { p.prior.mean_x = odd; });
    expect_lattice_refused("mean", [=](auto& p) { p.prior.mean_y = odd; });
    expect_lattice_refused("mean", [=](auto& p) { p.prior.mean_theta = odd; });
    expect_lattice_refused("weight", [=](auto& p) { p.prior.weight_xy = odd; });
    expect_lattice_refused("weight", [=](auto& p) { p.prior.weight_theta = odd; });
    expect_lattice_refused("limit", [=](auto& p) { p.prior.limit = odd; });
  }
  expect_lattice_refused("weight", [](auto& p) { p.prior.weight_xy = -1.0F; });
  expect_lattice_refused("weight", [](auto& p) { p.prior.weight_theta = -1.0e-30F; });
  expect_lattice_refused("limit", [](auto& p) { p.prior.limit = -1.0F; });
  expect_lattice_refused("limit", [](auto& p) { p.prior.limit = 1.0000001e9F; });
}

TEST(PoseLatticeCheck, RefusesSizesThatDoNotFit) {
  expect_lattice_refused("without samples", [](auto& p) { p.count_xy = 0; });
  expect_lattice_refused("without samples", [](auto& p) { p.count_theta = 0; });
  expect_lattice_refused("2^28", [](auto& p) { p.count_xy = 0xFFFFFFFFU; });
  expect_lattice_refused("2^28", [](auto& p) { p.count_theta = 0xFFFFFFFFU; });
  expect_lattice_refused("2^28", [](auto& p) { p.count_xy = 16385; });
  expect_lattice_refused("needs", [](auto& p) { p.count_theta = 6; });
  const PoseLattice::Params params{.count_xy = 3, .count_theta = 5};
  EXPECT_THROW(check<PoseLattice>(params, {45 * 16}, {44, 1, 1}), Error);
  EXPECT_THROW(check<PoseLattice>(params, {45 * 16 - 1}, {45, 1, 1}), Error);
  const PoseLattice::Params most{.count_xy = 16384, .count_theta = 1};
  EXPECT_NO_THROW(check<PoseLattice>(most, {std::size_t{1} << 32U}, {1U << 28U, 1, 1}));
  const PoseLattice::Params more{.count_xy = 16384, .count_theta = 2};
  EXPECT_THROW(check<PoseLattice>(more, {std::size_t{1} << 33U}, {1U << 29U, 1, 1}), Error);
}

TEST(LatticeMinimaCheck, RefusesSizesThatDoNotFit) {
  EXPECT_NO_THROW(check<LatticeMinima>({3, 5}, {180, 180}, {45, 1, 1}));
  EXPECT_THROW(check<LatticeMinima>({3, 5}, {179, 180}, {45, 1, 1}), Error);
  EXPECT_THROW(check<LatticeMinima>({3, 5}, {180, 179}, {45, 1, 1}), Error);
  EXPECT_THROW(check<LatticeMinima>({3, 5}, {180, 180}, {15, 3, 1}), Error);
  EXPECT_THROW(check<LatticeMinima>({0, 5}, {180, 180}, {0, 1, 1}), Error);
  EXPECT_THROW(check<LatticeMinima>({65536, 65536}, {180, 180}, {0, 1, 1}), Error);
}

TEST(SmallestValuesCheck, RefusesSizesThatDoNotFit) {
  EXPECT_NO_THROW(check<SmallestValues>({0, 16}, {0, 128}, {1, 1, 1}));
  EXPECT_THROW(check<SmallestValues>({0, 17}, {0, 136}, {1, 1, 1}), Error);
  EXPECT_THROW(check<SmallestValues>({0, 0}, {0, 128}, {1, 1, 1}), Error);
  EXPECT_THROW(check<SmallestValues>({3, 16}, {11, 128}, {1, 1, 1}), Error);
  EXPECT_THROW(check<SmallestValues>({3, 16}, {12, 127}, {1, 1, 1}), Error);
  EXPECT_THROW(check<SmallestValues>({3, 16}, {12, 128}, {3, 1, 1}), Error);
}

TEST(SeedScatterCheck, RefusesSizesThatDoNotFit) {
  EXPECT_NO_THROW(check<SeedScatter>({2, 5, 3, 8}, {8, 21}, {2, 1, 1}));
  EXPECT_NO_THROW(check<SeedScatter>({0, 0, 0, 0}, {0, 0}, {0, 1, 1}));
  EXPECT_THROW(check<SeedScatter>({3, 5, 3, 8}, {8, 21}, {3, 1, 1}), Error);
  EXPECT_THROW(check<SeedScatter>({2, 5, 3, 8}, {8, 20}, {2, 1, 1}), Error);
  EXPECT_THROW(check<SeedScatter>({2, 5, 3, 6}, {8, 21}, {2, 1, 1}), Error);
  EXPECT_THROW(check<SeedScatter>({2, 5, 3, 8}, {8, 21}, {1, 1, 1}), Error);
  EXPECT_THROW(check<SeedScatter>({2, 65536, 1, 65536}, {8, 65536}, {2, 1, 1}), Error);
  EXPECT_NO_THROW(check<SeedScatter>({2, 65535, 1, 65536}, {8, 65535}, {2, 1, 1}));
}

TEST(FieldGrowCheck, RefusesAnOldFieldThatSticksOut) {
  const FieldGrow::Params fits{.old_width = 3,
                               .old_height = 2,
                               .old_stride = 4,
                               .width = 8,
                               .height = 5,
                               .stride = 8,
                               .offset_x = 5,
                               .offset_y = 3,
                               .cap = 65535};
  EXPECT_NO_THROW(check<FieldGrow>(fits, {14, 80}, {8, 5, 1}));
  EXPECT_THROW(check<FieldGrow>(fits, {13, 80}, {8, 5, 1}), Error);
  EXPECT_THROW(check<FieldGrow>(fits, {14, 79}, {8, 5, 1}), Error);
  EXPECT_THROW(check<FieldGrow>(fits, {14, 80}, {8, 4, 1}), Error);
  const auto spoiled = [&](auto member, std::uint32_t value) {
    FieldGrow::Params bad = fits;
    bad.*member = value;
    return bad;
  };
  using P = FieldGrow::Params;
  for (const P& bad : {spoiled(&P::offset_x, 6), spoiled(&P::offset_y, 4), spoiled(&P::offset_x, 0xFFFFFFFEU),
                       spoiled(&P::offset_y, 0xFFFFFFFEU), spoiled(&P::cap, 65536), spoiled(&P::old_stride, 2),
                       spoiled(&P::old_width, 9), spoiled(&P::stride, 4)}) {
    EXPECT_THROW(check<FieldGrow>(bad, {1000, 1000}, {8, 5, 1}), Error);
  }
  EXPECT_NO_THROW(check<FieldGrow>({.width = 8, .height = 5, .stride = 8}, {0, 80}, {8, 5, 1}));
}

}  // namespace
}  // namespace gdtslam::test
