// A map that is larger than the memory meant for it: what is far from the robot waits on disk, and no cell differs from
// those of a map that has all of them in memory.
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/memory/scratch_file.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/map/store/growth.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "support/address_space.hpp"

namespace gdtslam {
namespace {

constexpr double kCell_m = 0.025;
constexpr std::uint32_t kDiskRadius = 20;
constexpr std::uint64_t kManyCells = std::uint64_t{8} << 30U;
constexpr double kSight_m = 25.0;

// Obstacles in a square around a place; cells on a lattice are hit again when the robot comes back.
std::vector<Point2> obstacles_around(const Point2& place_m, Random& random) {
  std::vector<Point2> points;
  for (int i = 0; i < 2500; ++i) {
    const auto draw = [&] { return std::floor(random.uniform(-kSight_m, kSight_m) / 0.4) * 0.4; };
    points.emplace_back(std::round(place_m.x()) + draw(), std::round(place_m.y()) + draw());
  }
  return points;
}

struct MapOnCpu {
  MapOnCpu()
      : backend(make_cpu_backend({})),
        field(*backend, kCell_m, kDiskRadius, kManyCells),
        local(*backend, kDiskRadius) {}
  void merge(const KeyframeCells& keyframe) {
    field.grow_to_hold(keyframe.window);
    local.prepare(keyframe, field);
    local.merge_into(field, {.rule = MergeRule::kWorking, .threshold = 1024, .lift = 512});
  }
  std::unique_ptr<Backend> backend;
  GlobalField field;
  LocalField local;
};

// There and back along a line, farther than a piece of address space reaches, with a turn to the side on the way. On
// the way back some of what was seen on the way there is seen again, by half or less.
std::vector<Point2> long_way() {
  std::vector<Point2> way;
  for (double x_m = 0.0; x_m < 1800.0; x_m += 90.0) way.emplace_back(x_m, x_m > 900.0 ? 60.0 : -20.0);
  for (double x_m = 1800.0; x_m > -300.0; x_m -= 105.0) way.emplace_back(x_m, 10.0);
  return way;
}

bool rows_are_equal(const GlobalField& a, const GlobalField& b, const CellBox& box, std::int32_t every = 1) {
  std::vector<std::uint16_t> row_a(static_cast<std::size_t>(box.width()));
  std::vector<std::uint16_t> row_b(row_a.size());
  for (std::int32_t y = box.min.y; y < box.end.y; y += every) {
    a.read_row({box.min.x, y}, row_a);
    b.read_row({box.min.x, y}, row_b);
    if (row_a != row_b) return false;
  }
  return true;
}

TEST(FieldOnDisk, HasEveryCellOfTheMapThatIsInMemory) {
  MapOnCpu whole;
  MapOnCpu near;
  near.field.keep_near(testing::TempDir());
  Random random(7);
  std::vector<CellBox> seen;
  for (const Point2& place : long_way()) {
    const KeyframeCells keyframe = keyframe_of(obstacles_around(place, random), kCell_m, kDiskRadius);
    seen.push_back(keyframe.window);
    whole.merge(keyframe);
    near.merge(keyframe);
    ASSERT_EQ(near.field.taken_cells(), whole.field.taken_cells());
  }
  // Some of it waits on disk: not all is in one piece of address space.
  EXPECT_GT(whole.field.box().width(), near.field.stored().width());
  EXPECT_EQ(near.field.box(), whole.field.box());
  for (const CellBox& window : seen) EXPECT_TRUE(rows_are_equal(near.field, whole.field, window));
  EXPECT_TRUE(rows_are_equal(near.field, whole.field, whole.field.box(), 509)) << "nothing beside that";
  for (int i = 0; i < 2000; ++i) {
    const CellIndex cell{static_cast<std::int32_t>(random.uniform(-14000.0, 74000.0)),
                         static_cast<std::int32_t>(random.uniform(-3300.0, 4900.0))};
    ASSERT_EQ(near.field.at_and_beside(cell), whole.field.at_and_beside(cell)) << cell.x << ' ' << cell.y;
  }
}

// The map of a device that was lost is whole in memory before any of it waits: in a piece of address space as others,
// or in a larger one, all of which goes to disk in the end. A second call takes nothing back.
TEST(FieldOnDisk, BeginsWhereMuchIsKnownAlready) {
  for (const std::size_t begin : {std::size_t{5}, std::size_t{18}}) {
    MapOnCpu whole;
    MapOnCpu near;
    Random random(7);
    std::vector<CellBox> seen;
    for (const Point2& place : long_way()) {
      if (seen.size() == begin || seen.size() == begin + 20) near.field.keep_near(testing::TempDir());
      const KeyframeCells keyframe = keyframe_of(obstacles_around(place, random), kCell_m, kDiskRadius);
      seen.push_back(keyframe.window);
      whole.merge(keyframe);
      near.merge(keyframe);
      ASSERT_EQ(near.field.taken_cells(), whole.field.taken_cells());
    }
    near.field.come_near({{-200000, 0}, {-199000, 1000}});
    EXPECT_TRUE(common_part(near.field.stored(), whole.field.box()).empty()) << "some of it does not wait on disk";
    EXPECT_EQ(near.field.box(), whole.field.box());
    for (const CellBox& window : seen) EXPECT_TRUE(rows_are_equal(near.field, whole.field, window, 7)) << begin;
    EXPECT_TRUE(rows_are_equal(near.field, whole.field, whole.field.box(), 1009)) << "nothing beside that";
  }
}

// What kernels look up there, the cell beside the last one of a strip included, is what they find in the whole map.
TEST(FieldOnDisk, KernelsFindTheSameOnceTheBoxIsNear) {
  MapOnCpu whole;
  MapOnCpu near;
  near.field.keep_near(testing::TempDir());
  Random random(11);
  std::vector<PointCells> points;
  for (int i = 0; i < 300; ++i) {
    points.push_back(
        {static_cast<float>(random.uniform(-1000.0, 1000.0)), static_cast<float>(random.uniform(-1000.0, 1000.0))});
  }
  int looked_up = 0;
  for (const Point2& place : long_way()) {
    const CellIndex at = map_cell_of(place, kCell_m);
    near.field.come_near({at - CellOffset{1100, 1100}, at + CellOffset{1100, 1100}});
    if (!whole.field.box().empty()) {
      const auto costs_in = [&](const MapOnCpu& map) {
        Objective objective(map.field, Interpolation::kBilinear, CostForm::kDistance);
        objective.set_anchor(at);
        objective.set_points(points);
        objective.set_cap(map.field.cap());
        std::vector<CellPose> poses;
        for (int k = 0; k < 8; ++k)
          poses.push_back({0.31F * static_cast<float>(k), 0.17F, 0.01F * static_cast<float>(k)});
        std::vector<std::uint32_t> costs(poses.size());
        objective.evaluate(poses, costs);
        return costs;
      };
      ASSERT_EQ(costs_in(near), costs_in(whole)) << place.transpose();
      ++looked_up;
    }
    const KeyframeCells keyframe = keyframe_of(obstacles_around(place, random), kCell_m, kDiskRadius);
    whole.merge(keyframe);
    near.merge(keyframe);
  }
  EXPECT_GT(looked_up, 35);
}

// A box of whole tiles of 64 cells around which a piece of 960 tiles a side is laid, 472 of them before it: the first
// block of that piece begins with tile (0, 0).
constexpr std::int32_t kTileCells = 64;
CellBox square_of_tiles(std::int32_t first, std::int32_t tiles) {
  const CellIndex min{first * kTileCells, first * kTileCells};
  return {min, min + CellOffset{tiles * kTileCells, tiles * kTileCells}};
}

// 2^32 cells of tiles of 65 by 72 are 917,739: with 8 tiles more on each side, 128 rows of 7,169 are less and of 7,170
// more.
TEST(FieldOnDisk, AScanThatReachesOverMoreCellsThanAreCountedIsRefused) {
  MapOnCpu near;
  near.field.keep_near(testing::TempDir());
  const auto tiles = [](std::int32_t width) {
    return CellBox{{0, 8 * kTileCells}, {width * kTileCells, (8 + 112) * kTileCells}};
  };
  near.field.come_near(tiles(1000));
  const CellBox stored = near.field.stored();
  try {
    near.field.come_near(tiles(7695));
    FAIL() << "took more than 2^32 cells";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a scan reaches over 492480 x 7168 cells, more than 2^32"));
    EXPECT_FALSE(error.has_position());
  }
  EXPECT_EQ(near.field.stored(), stored) << "as it was";
}

// What stands in the very first block of a piece comes back from disk, goes along to another piece that holds it, and
// back to disk with one that does not.
TEST(FieldOnDisk, TheFirstBlockOfAPieceIsOneAsTheOthers) {
  if (test::is_address_space_bounded())
    GTEST_SKIP() << "NOTHING WAS TESTED: the address space is bounded, and pieces are smaller and begin elsewhere";
  MapOnCpu whole;
  MapOnCpu near;
  near.field.keep_near(testing::TempDir());
  std::vector<Point2> points;
  for (int k = 5; k < 60; ++k) points.emplace_back(kCell_m * (k + 0.5), kCell_m * (3 * k + 0.5));
  const KeyframeCells keyframe = keyframe_of(points, kCell_m, kDiskRadius);
  whole.merge(keyframe);
  near.merge(keyframe);
  const CellBox box = whole.field.box();
  const auto is_still_there = [&] { return rows_are_equal(near.field, whole.field, box); };
  near.field.come_near(square_of_tiles(2000, 16));
  ASSERT_TRUE(common_part(near.field.stored(), box).empty()) << "it waits on disk";
  EXPECT_TRUE(is_still_there());
  near.field.come_near(square_of_tiles(472, 16));
  ASSERT_EQ(near.field.stored().min, (CellIndex{0, 0}));
  near.field.come_near(square_of_tiles(8, 16));
  ASSERT_EQ(near.field.stored().min, (CellIndex{0, 0})) << "the same piece";
  EXPECT_TRUE(is_still_there()) << "back from disk";
  near.field.come_near(square_of_tiles(-100, 16));
  ASSERT_LT(near.field.stored().min.x, -100 * kTileCells);
  ASSERT_GT(near.field.stored().end.x, 0);
  EXPECT_TRUE(is_still_there()) << "in another piece";
  near.field.come_near(square_of_tiles(472, 16));
  near.field.come_near(square_of_tiles(2000, 16));
  EXPECT_TRUE(is_still_there()) << "on disk again";
  near.field.come_near(square_of_tiles(472, 16));
  near.field.come_near(square_of_tiles(8, 16));
  near.field.come_near(square_of_tiles(-3000, 16));
  EXPECT_TRUE(is_still_there()) << "on disk out of the first block";
}

TEST(FieldOnDisk, NamesTheFolderThatTakesNoFile) {
  MapOnCpu map;
  map.field.keep_near("/proc/no-such-folder");
  Random random(3);
  const auto drive = [&] {
    for (const Point2& place : long_way())
      map.merge(keyframe_of(obstacles_around(place, random), kCell_m, kDiskRadius));
  };
  try {
    drive();
    FAIL() << "no error";
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/proc/no-such-folder"));
  }
}

TEST(ScratchFile, HasWhatWasWrittenAndLeavesNothingBehind) {
  const std::string folder = testing::TempDir() + "/scratch-" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  const std::array<std::uint32_t, 3> words{5, 7, 11};
  {
    ScratchFile file(folder);
    file.write(1000, std::as_bytes(std::span(words)));
    std::array<std::uint32_t, 2> last{};
    file.read(1004, std::as_writable_bytes(std::span(last)));
    EXPECT_THAT(last, testing::ElementsAre(7, 11));
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    EXPECT_THROW(file.read(1008, std::as_writable_bytes(std::span(last))), FileError);  // beyond its end
  }
  std::filesystem::remove(folder);
}

}  // namespace
}  // namespace gdtslam
