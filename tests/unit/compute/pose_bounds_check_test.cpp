// What the kernel of pose_bounds.hpp refuses, each limit at its edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Two dilations of four planes of 20 x 10 samples, 100 points and 7 tiles of 16 x 4.
struct BoundsLaunch {
  PoseBounds::Params params{.width = 20,
                            .height = 10,
                            .phase_bits = 1,
                            .point_count = 100,
                            .last_field = 800,
                            .tile_width = 16,
                            .tile_height = 4};
  Extent threads{7, 1, 1};
  std::vector<std::size_t> bytes{1600, 1200, 112, 1792};

  void check() const { check_launch(PoseBounds::info(), {bytes, std::as_bytes(std::span(&params, 1)), threads}); }
};

using BoundsChange = std::function<void(BoundsLaunch&)>;

void expect_taken(const BoundsChange& change) {
  BoundsLaunch launch;
  change(launch);
  EXPECT_NO_THROW(launch.check());
}

void expect_refused(const BoundsChange& change, const char* message) {
  BoundsLaunch launch;
  change(launch);
  EXPECT_THAT([&] { launch.check(); }, ThrowsMessage<Error>(HasSubstr(message)));
}

void make_small(BoundsLaunch& launch) { launch.params.tile_width = launch.params.tile_height = 2; }

TEST(PoseBoundsCheck, TakesTilesOfTwoShapesWithinAPlane) {
  expect_taken([](BoundsLaunch&) {});
  expect_taken(make_small);
  expect_taken([](BoundsLaunch& l) { l.threads.x = 0; });
  expect_refused([](BoundsLaunch& l) { l.params.tile_width = 2; }, "tiles are 2 x 2 or 16 x 4");
  expect_refused([](BoundsLaunch& l) { l.params.tile_height = 2; }, "tiles are 2 x 2 or 16 x 4");
  expect_taken([](BoundsLaunch& l) { l.params.width = 16, l.params.height = 4; });
  expect_refused([](BoundsLaunch& l) { l.params.width = 15; }, "smaller than a tile");
  expect_refused([](BoundsLaunch& l) { l.params.height = 3; }, "smaller than a tile");
  expect_refused([](BoundsLaunch& l) { make_small(l), l.params.width = 1; }, "smaller than a tile");
  expect_refused([](BoundsLaunch& l) { l.threads.y = 2; }, "extent");
}

TEST(PoseBoundsCheck, RefusesBuffersThatAreTooSmall) {
  expect_refused([](BoundsLaunch& l) { l.bytes[0] = 1599; }, "buffer 0");
  expect_refused([](BoundsLaunch& l) { l.bytes[1] = 1199; }, "buffer 1");
  expect_refused([](BoundsLaunch& l) { l.bytes[2] = 111; }, "buffer 2");
  expect_refused([](BoundsLaunch& l) { l.bytes[3] = 1791; }, "buffer 3");
  expect_taken([](BoundsLaunch& l) { make_small(l), l.bytes[3] = 112; });
  expect_refused([](BoundsLaunch& l) { make_small(l), l.bytes[3] = 111; }, "buffer 3");
  expect_refused([](BoundsLaunch& l) { l.params.last_field = 801; }, "buffer 0");
  expect_refused([](BoundsLaunch& l) { l.params.phase_bits = 2; }, "buffer 0");
}

TEST(PoseBoundsCheck, RefusesWhatCannotBeCounted) {
  constexpr std::size_t kPlenty = std::size_t{1} << 40U;
  const auto roomy = [](BoundsLaunch& l) { l.bytes = {kPlenty, kPlenty, kPlenty, kPlenty}; };
  expect_taken([&](BoundsLaunch& l) { roomy(l), l.params.phase_bits = 4; });
  expect_refused([&](BoundsLaunch& l) { roomy(l), l.params.phase_bits = 5; }, "more than 2^4 samples a spacing");
  // 4 planes of 2^31 samples together are one too many.
  expect_refused(
      [&](BoundsLaunch& l) { roomy(l), l.params.width = l.params.height = 1U << 15U, l.params.phase_bits = 1; },
      "a dilation of 2^31 samples");
  expect_taken([&](BoundsLaunch& l) {
    roomy(l), l.params.width = 1U << 15U, l.params.height = (1U << 14U) - 1, l.params.phase_bits = 1;
  });
  expect_refused([&](BoundsLaunch& l) { roomy(l), l.params.width = l.params.height = 0xFFFFFFFFU; },
                 "a dilation of 2^31 samples");
  expect_taken([&](BoundsLaunch& l) { roomy(l), l.params.last_field = 0xFFFFFFFFU - 800; });
  expect_refused([&](BoundsLaunch& l) { roomy(l), l.params.last_field = 0xFFFFFFFFU - 799; },
                 "a field of 2^32 samples");
  expect_taken([&](BoundsLaunch& l) { roomy(l), l.params.point_count = 65537; });
  expect_refused([&](BoundsLaunch& l) { roomy(l), l.params.point_count = 65538; }, "more than 65,537 points");
}

TEST(PoseBoundsCheck, RefusesAnchorsAndScalesThatLeadNowhere) {
  constexpr std::int32_t kFarthest = 1 << 21;
  expect_taken([](BoundsLaunch& l) { l.params.first_column = -kFarthest, l.params.first_row = kFarthest; });
  expect_refused([](BoundsLaunch& l) { l.params.first_column = kFarthest + 1; }, "2^21");
  expect_refused([](BoundsLaunch& l) { l.params.first_column = -kFarthest - 1; }, "2^21");
  expect_refused([](BoundsLaunch& l) { l.params.first_row = kFarthest + 1; }, "2^21");
  expect_refused([](BoundsLaunch& l) { l.params.first_row = -kFarthest - 1; }, "2^21");
  for (const float scale :
       {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    expect_refused([scale](BoundsLaunch& l) { l.params.samples_per_cell = scale; }, "no positive number");
  }
}

}  // namespace
}  // namespace gdtslam::test
