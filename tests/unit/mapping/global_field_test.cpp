// The map's store: growth keeps what is known, the guard stays at the cap, sizes are refused before they are allocated.
// And the local field against plain distances.
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/map/store/field_store.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "support/queued_backend.hpp"
#include "support/small_cpu.hpp"

namespace gdtslam {
namespace {

constexpr double kFieldResolution = 0.05;
constexpr std::uint32_t kFieldRadius = 12;
constexpr MergeStep kFieldStep{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};

void merge_into(GlobalField& map, LocalField& local, const KeyframeCells& keyframe) {
  map.grow_to_hold(keyframe.window);
  local.prepare(keyframe, map);
  local.merge_into(map, kFieldStep);
}

class Fields : public testing::Test {
 protected:
  // Nearest of the points' cells in cells, by looking at all of them.
  static double distance_to_nearest(const std::vector<CellIndex>& seeds, CellIndex cell) {
    double best = 1e9;
    for (const CellIndex& s : seeds) best = std::min(best, std::hypot(s.x - cell.x, s.y - cell.y));
    return best;
  }

  // Merges a keyframe and returns it.
  KeyframeCells merge(const std::vector<Point2>& points) {
    const KeyframeCells keyframe = make_keyframe_cells(points, kFieldResolution, kFieldRadius);
    map_.grow_to_hold(keyframe.window);
    local_.prepare(keyframe, map_);
    local_.merge_into(map_, kFieldStep);
    return keyframe;
  }

  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField map_{*backend_, kFieldResolution, kFieldRadius, 1U << 20U};
  LocalField local_{*backend_, kFieldRadius};
};

TEST_F(Fields, AFreshMapIsUnknownEverywhere) {
  EXPECT_EQ(map_.at({0, 0}), map_.cap());
  map_.grow_to_hold({{-5, -7}, {20, 30}});
  for (int y = -10; y < 40; ++y) {
    for (int x = -10; x < 30; ++x) ASSERT_EQ(map_.at({x, y}), map_.cap()) << x << ' ' << y;
  }
}

TEST_F(Fields, LocalFieldIsTheDistanceToTheNearestPointRoundedTo256thsOfACell) {
  // Cell centres, so that no rounding decides the seed cells.
  const std::vector<CellIndex> seeds{{3, 4}, {10, -6}, {-8, 2}};
  std::vector<Point2> points;
  for (const CellIndex& s : seeds) points.emplace_back((s.x + 0.5) * kFieldResolution, (s.y + 0.5) * kFieldResolution);
  const CellBox window{{-8 - 12, -6 - 12}, {10 + 13, 4 + 13}};
  EXPECT_EQ(merge(points).window, window);
  for (int y = window.min.y; y < window.end.y; ++y) {
    for (int x = window.min.x; x < window.end.x; ++x) {
      const double exact = std::min(distance_to_nearest(seeds, {x, y}), static_cast<double>(kFieldRadius)) * 256.0;
      ASSERT_NEAR(map_.at({x, y}), exact, 0.5) << x << ' ' << y;
    }
  }
}

// Jump flooding over the same keyframe: where one seed is nearest by far it is right, and it never says less.
TEST(LocalFieldByJumpFlooding, IsTheExactOneButForCellsThatAreTooLarge) {
  std::vector<Point2> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(0.05 * ((i * 73) % 211), 0.05 * ((i * 131) % 197));
  const KeyframeCells keyframe = make_keyframe_cells(points, kFieldResolution, kFieldRadius);
  const auto backend = make_cpu_backend({});
  const auto mapped = [&](DistanceTransform transform, std::uint64_t kernels) {
    GlobalField map(*backend, kFieldResolution, kFieldRadius, 1U << 20U);
    LocalField local(*backend, kFieldRadius, transform);
    map.grow_to_hold(keyframe.window);
    const std::uint64_t before = backend->dispatch_count();
    local.prepare(keyframe, map);
    local.merge_into(map, kFieldStep);
    EXPECT_EQ(backend->dispatch_count() - before, kernels);
    return map.download();
  };
  const std::vector<std::uint16_t> exact = mapped(DistanceTransform::kExact, 1);
  const std::vector<std::uint16_t> flooded =
      mapped(DistanceTransform::kJumpFlood, 10);  // seeds, start, steps 1, 8, 4, 2, 1, distances, field, merge
  ASSERT_EQ(flooded.size(), exact.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_GE(flooded[i], exact[i]) << i;
    wrong += flooded[i] != exact[i] ? 1U : 0U;
  }
  EXPECT_LT(wrong, exact.size() / 1000);
  EXPECT_LT(*std::min_element(flooded.begin(), flooded.end()), kFieldOne);
}

TEST_F(Fields, GrowingKeepsWhatIsKnownAndTheGuard) {
  map_.grow_to_hold({{0, 0}, {30, 30}});
  merge({{0.525, 0.525}});
  const std::uint16_t known = map_.at({12, 13});
  ASSERT_LT(known, map_.cap());
  for (const CellBox& box : {CellBox{{-300, 0}, {10, 10}}, CellBox{{0, -290}, {10, 10}}, CellBox{{0, 0}, {400, 10}},
                             CellBox{{0, 0}, {10, 380}}}) {
    map_.grow_to_hold(box);
    EXPECT_EQ(map_.at({12, 13}), known);
    EXPECT_EQ(map_.at({10, 10}), 0);
  }
  const GridGeometry g = map_.geometry();
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      if (x >= 2 && y >= 2 && x < g.width - 2 && y < g.height - 2) continue;
      ASSERT_EQ(map_.at(map_.box().min + CellOffset{x, y}), map_.cap());
    }
  }
}

// On a device. Drives through a corridor up to the bound, half a metre a keyframe, and back and forth in steps to the
// side; the stored grid changes when the map is copied, which without a margin is at every one.
TEST(FieldsInRows, GrowingUpToTheBoundCopiesTheMapAFewTimes) {
  constexpr std::int32_t kKeyframes = 1500;
  constexpr std::int32_t kEnd = 10 * kKeyframes;
  const auto cells = [](std::int64_t width, std::int64_t height) { return static_cast<std::uint64_t>(width * height); };
  test::QueuedBackend device;
  // Rows are padded to 32 cells.
  GlobalField map{device, kFieldResolution, kFieldRadius, cells(kEnd + 100, 204 + kKeyframes / 10)};
  int copies = 0;
  GridGeometry before = map.geometry();
  for (std::int32_t k = 0; k < kKeyframes; ++k) {
    const std::int32_t x = 10 * k;
    const std::int32_t side = k / 10;
    map.grow_to_hold(k % 2 == 0 ? CellBox{{x, 0}, {x + 10, 200}} : CellBox{{x, side}, {x + 10, side + 200}});
    const GridGeometry after = map.geometry();
    copies += after == before ? 0 : 1;
    before = after;
    ASSERT_LE(cells(map.layout().stride, after.height), cells(kEnd + 100, 204 + kKeyframes / 10));
  }
  EXPECT_LE(copies, 60);
  EXPECT_GE(before.width, kEnd + 4);
}

// A margin is room to spare: what it takes may not keep the map from growing elsewhere.
TEST(FieldsInRows, AMarginIsGivenUpWhereItIsInTheWay) {
  test::QueuedBackend device;
  const auto cpu = make_cpu_backend({});
  GlobalField map{device, kFieldResolution, kFieldRadius, 416U * 420U};
  GlobalField large{*cpu, kFieldResolution, kFieldRadius, 1U << 24U};
  LocalField local{device, kFieldRadius};
  LocalField local_on_cpu{*cpu, kFieldRadius};
  for (const Point2& point :
       {Point2{0.525, 0.525}, Point2{19.025, 0.525}, Point2{0.525, 19.025}, Point2{19.025, 19.025}}) {
    const KeyframeCells keyframe = make_keyframe_cells({point}, kFieldResolution, kFieldRadius);
    merge_into(map, local, keyframe);
    merge_into(large, local_on_cpu, keyframe);
  }
  const std::vector<std::uint16_t> cells = map.download();
  const CellBox box = map.box();
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x; ++x) {
      const std::int32_t place = (y - box.min.y) * box.width() + x - box.min.x;
      ASSERT_EQ(cells[static_cast<std::size_t>(place)], large.at({x, y})) << x << ' ' << y;
    }
  }
  EXPECT_EQ(large.at({380, 380}), 0);
  EXPECT_LE(map.geometry().width, 416);
  EXPECT_LE(map.geometry().height, 420);
  EXPECT_THROW(map.grow_to_hold({{0, 0}, {450, 450}}), InputError);
}

// Keyframes all over the place, into a field that copies its tiles whenever it has to grow and into one that never
// does: the same values everywhere, which are those of a field of the whole from the start.
TEST(FieldsInStrips, HoldTheSameWhetherTheyMoveOrNot) {
  test::SmallCpu small;
  const auto cpu = make_cpu_backend({});
  GlobalField moving{small, kFieldResolution, kFieldRadius, 1U << 30U};
  GlobalField roomy{*cpu, kFieldResolution, kFieldRadius, 1U << 30U};
  LocalField local{small, kFieldRadius};
  LocalField local_on_cpu{*cpu, kFieldRadius};
  Random random(3);
  int moves = 0;
  for (int k = 0; k < 60; ++k) {
    std::vector<Point2> points;
    const Point2 centre{random.uniform(-2.0, 2.0) * k, random.uniform(-2.0, 2.0) * k};
    for (int i = 0; i < 40; ++i)
      points.push_back(centre + Point2{random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)});
    const KeyframeCells keyframe = make_keyframe_cells(points, kFieldResolution, kFieldRadius);
    const std::uint64_t before = moving.buffer().id();
    merge_into(moving, local, keyframe);
    moves += moving.buffer().id() == before ? 0 : 1;
    merge_into(roomy, local_on_cpu, keyframe);
    ASSERT_EQ(moving.taken_cells(), roomy.taken_cells());
  }
  EXPECT_GE(moves, 5);
  EXPECT_NE(moving.layout(), roomy.layout());
  EXPECT_EQ(moving.box(), roomy.box());
  const CellBox box = moving.box();
  for (std::int32_t y = box.min.y; y < box.end.y - 1; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x - 1; ++x) {
      const std::array<std::uint16_t, 4> each{roomy.at({x, y}), roomy.at({x + 1, y}), roomy.at({x, y + 1}),
                                              roomy.at({x + 1, y + 1})};
      ASSERT_EQ(moving.at_and_beside({x, y}), each) << x << ' ' << y;
      ASSERT_EQ(roomy.at_and_beside({x, y}), each) << x << ' ' << y;
    }
  }
}

// Two rooms a kilometre apart take the memory of two rooms.
TEST(FieldsInStrips, TakeMemoryWhereSomethingIsKnown) {
  const auto cpu = make_cpu_backend({});
  GlobalField map{*cpu, kFieldResolution, kFieldRadius, 1U << 20U};
  LocalField local{*cpu, kFieldRadius};
  for (const Point2& point : {Point2{0.0, 0.0}, Point2{700.0, 700.0}}) {
    merge_into(map, local, make_keyframe_cells({point}, kFieldResolution, kFieldRadius));
  }
  EXPECT_GE(map.geometry().cell_count(), 14000U * 14000U);
  EXPECT_LE(map.taken_cells(), 2U * 4U * 64U * 64U);
  EXPECT_EQ(map.at({14000, 14000}), 0);
  EXPECT_EQ(map.at({7000, 7000}), map.cap());
  // Pages of 4 KiB that the system gave, of 0.4 GB that rows of the box would take.
  const auto memory = std::as_bytes(map.memory());
  std::vector<unsigned char> is_there(memory.size() / 4096 + 1);
  ASSERT_EQ(mincore(const_cast<std::byte*>(memory.data()), memory.size(), is_there.data()), 0);
  EXPECT_LE(std::count_if(is_there.begin(), is_there.end(), [](unsigned char page) { return (page & 1U) != 0; }), 40);
}

TEST(FieldsInStrips, MoreKnownCellsThanAllowedAreRefused) {
  const auto cpu = make_cpu_backend({});
  GlobalField map{*cpu, kFieldResolution, kFieldRadius, 3U * 64U * 64U};
  LocalField local{*cpu, kFieldRadius};
  merge_into(map, local,
             make_keyframe_cells({{1.6, 0.0}}, kFieldResolution, kFieldRadius));  // two tiles, one above the other
  const KeyframeCells corner =
      make_keyframe_cells({{3.2, 3.2}}, kFieldResolution, kFieldRadius);  // four, one of them there
  EXPECT_THAT([&] { merge_into(map, local, corner); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("20480 known cells, more than map.max_megacells")));
  EXPECT_EQ(map.taken_cells(), 2U * 64U * 64U);
  EXPECT_EQ(map.at({64, 64}), map.cap());
  merge_into(map, local, make_keyframe_cells({{1.6, 0.05}}, kFieldResolution, kFieldRadius));  // where there is room
  EXPECT_EQ(map.at({32, 1}), 128);  // between a cell away and none
}

// The host's copy of a device's field takes that over from its rows, and what it knew before is gone.
TEST(FieldsInStrips, TakeOverRows) {
  const auto cpu = make_cpu_backend({});
  GlobalField map{*cpu, kFieldResolution, kFieldRadius, 1U << 24U};
  LocalField local{*cpu, kFieldRadius};
  for (const Point2& point : {Point2{-3.2, 0.0}, Point2{0.0, 0.0}, Point2{9.0, 9.0}}) {
    merge_into(map, local, make_keyframe_cells({point}, kFieldResolution, kFieldRadius));
  }
  const CellBox box{{-40, -30}, {110, 90}};
  Random random(5);
  std::vector<std::uint16_t> rows(160U * 120U);
  for (std::uint16_t& cell : rows) cell = static_cast<std::uint16_t>(random.below(map.cap() + 1U));
  map.adopt({rows, 160, box});
  for (std::int32_t y = map.box().min.y; y < map.box().end.y - 1; ++y) {
    for (std::int32_t x = map.box().min.x; x < map.box().end.x - 1; ++x) {
      const auto expected = [&](std::int32_t u, std::int32_t v) {
        return box.contains({u, v}) ? rows[static_cast<std::size_t>((v + 30) * 160 + u + 40)] : map.cap();
      };
      const std::array<std::uint16_t, 4> each{expected(x, y), expected(x + 1, y), expected(x, y + 1),
                                              expected(x + 1, y + 1)};
      ASSERT_EQ(map.at_and_beside({x, y}), each) << x << ' ' << y;
    }
  }
}

TEST_F(Fields, AMapThatWouldBeTooLargeIsRefusedWithBothSizesAndStaysAsItWas) {
  map_.grow_to_hold({{0, 0}, {30, 30}});
  const GridGeometry before = map_.geometry();
  try {
    map_.grow_to_hold({{0, 0}, {2000000, 2000000}});
    FAIL() << "a map of 4e12 cells was accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("2000"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("map.resolution"), std::string::npos) << e.what();
  }
  EXPECT_EQ(map_.geometry(), before);
}

}  // namespace
}  // namespace gdtslam
