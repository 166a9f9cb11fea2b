// Tiles of a map: each has the cells of the map of all keyframes, alone and with others.
#include "engine/runs/tiles/map_tiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

// Drives through streets of 30 m between walls that come and go, over corners of tiles on both sides of the origin.
RunKeyframes drive_over_tiles() {
  RunKeyframes run;
  Random random(5);
  for (std::size_t k = 0; k < 60; ++k) {
    RunKeyframe keyframe;
    keyframe.scan = k;
    const double turn = 0.1 * static_cast<double>(k);
    keyframe.T_map_base = {45.0 * std::cos(turn) - 20.0, 38.0 * std::sin(turn) + 5.0, 1.7 * turn};
    keyframe.laser.first_bearing_rad = -std::numbers::pi / 2.0;
    keyframe.laser.bearing_step_rad = std::numbers::pi / 180.0;
    for (int beam = 0; beam < 181; ++beam) {
      const bool is_lost = random.uniform(0.0, 1.0) < 0.1;
      keyframe.laser.ranges_m.push_back(is_lost ? std::numeric_limits<float>::infinity()
                                                : static_cast<float>(random.uniform(0.5, 24.0)));
    }
    run.keyframes.push_back(keyframe);
  }
  return run;
}

struct WholeMap {
  explicit WholeMap(const RunKeyframes& run)
      : distances(map_of_keyframes(run, MapperConfig{})), builder(OccupancyConfig{}, occupancy_limits(MapperConfig{})) {
    for (const RunKeyframe& keyframe : run.keyframes) builder.add(keyframe.laser, keyframe.T_map_base);
    occupancy = builder.build();
    corner = {static_cast<std::int32_t>(std::lround(occupancy.geometry.origin_x_m / occupancy.geometry.resolution_m)),
              static_cast<std::int32_t>(std::lround(occupancy.geometry.origin_y_m / occupancy.geometry.resolution_m))};
  }
  [[nodiscard]] CellState state(CellIndex cell) const {
    const CellOffset d = cell - corner;
    const bool is_inside =
        d.dx >= 0 && d.dy >= 0 && d.dx < occupancy.geometry.width && d.dy < occupancy.geometry.height;
    return is_inside ? occupancy.at({d.dx, d.dy}) : CellState::kUnknown;
  }
  std::unique_ptr<SeparateMap> distances;
  OccupancyBuilder builder;
  OccupancyMap occupancy;
  CellIndex corner;
};

std::vector<MapTile> made(const TileMaker& maker, std::span<const CellIndex> places) {
  std::vector<MapTile> tiles;
  maker.make(
      places, [&](MapTile&& tile) { tiles.push_back(std::move(tile)); }, [](double) {});
  return tiles;
}

void expect_cells_of(const WholeMap& whole, const MapTile& tile) {
  std::size_t wrong = 0;
  std::vector<std::uint16_t> row(kMapTileSide);
  for (std::int32_t y = 0; y < kMapTileSide; ++y) {
    const CellIndex first{tile.place.x * kMapTileSide, tile.place.y * kMapTileSide + y};
    whole.distances->field().read_row(first, row);
    for (std::int32_t x = 0; x < kMapTileSide; ++x) {
      const auto cell = static_cast<std::size_t>(y) * kMapTileSide + static_cast<std::size_t>(x);
      const bool is_same = tile.distances[cell] == row[static_cast<std::size_t>(x)] &&
                           tile.occupancy.at({x, y}) == whole.state(first + CellOffset{x, 0});
      wrong += is_same ? 0U : 1U;
    }
  }
  EXPECT_EQ(wrong, 0U) << "in tile " << tile.place.x << ' ' << tile.place.y;
}

TEST(TileMaker, TilesAreTheMapOfAllKeyframes) {
  const RunKeyframes run = drive_over_tiles();
  const WholeMap whole(run);
  const TileMaker maker(run, {}, {});
  const std::vector<MapTile> tiles = made(maker, maker.places());
  ASSERT_GE(tiles.size(), 6U);
  std::uint64_t known = 0;
  for (const MapTile& tile : tiles) {
    expect_cells_of(whole, tile);
    EXPECT_GT(tile.keyframes, 0U);
    for (const CellState state : tile.occupancy.cells.all()) known += state == CellState::kUnknown ? 0U : 1U;
  }
  // No cell of the map lies in none of them.
  std::uint64_t all = 0;
  for (const CellState state : whole.occupancy.cells.all()) all += state == CellState::kUnknown ? 0U : 1U;
  EXPECT_EQ(known, all);
}

TEST(TileMaker, ATileThatIsMadeAloneIsTheSame) {
  const RunKeyframes run = drive_over_tiles();
  const TileMaker maker(run, {}, {});
  for (const MapTile& together : made(maker, maker.places())) {
    const std::vector<MapTile> alone = made(maker, {&together.place, 1});
    ASSERT_EQ(alone.size(), 1U);
    EXPECT_EQ(alone.front().distances, together.distances);
    EXPECT_EQ(alone.front().occupancy.cells, together.occupancy.cells);
    EXPECT_EQ(alone.front().keyframes, together.keyframes);
    EXPECT_LT(alone.front().keyframes, run.keyframes.size());
  }
}

TEST(TileMaker, WithoutOccupancyDistancesAreTheSame) {
  const RunKeyframes run = drive_over_tiles();
  const TileMaker both(run, {}, {});
  const TileMaker maker(run, {}, {}, {}, TileParts::kDistances);
  EXPECT_FALSE(maker.has_occupancy());
  const std::vector<MapTile> tiles = made(maker, maker.places());
  ASSERT_GE(tiles.size(), 6U);
  EXPECT_EQ(tiles.size(), made(both, both.places()).size()) << "those where beams only pass among them";
  for (const MapTile& tile : tiles) {
    EXPECT_EQ(tile.occupancy.cells.size(), 0U);
    const std::vector<MapTile> with = made(both, {&tile.place, 1});
    ASSERT_EQ(with.size(), 1U);
    EXPECT_EQ(tile.distances, with.front().distances);
    EXPECT_EQ(tile.occupancy.geometry, with.front().occupancy.geometry);
  }
}

}  // namespace
}  // namespace gdtslam
