// The distance field of an occupancy map against the nearest of all its occupied cells.
#include "engine/runs/localizer/obstacle_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

OccupancyMap map_of(std::int32_t width, std::int32_t height, const std::vector<CellState>& states) {
  OccupancyMap map;
  map.geometry = {0.05, -3.0, 7.0, width, height};
  map.cells = CellStates(states);
  return map;
}

OccupancyMap sprinkled(std::int32_t width, std::int32_t height, double share, std::uint64_t seed) {
  Random random(seed);
  std::vector<CellState> states(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (CellState& state : states) {
    const double draw = random.uniform();
    state = draw < share ? CellState::kOccupied : draw < 0.5 ? CellState::kFree : CellState::kUnknown;
  }
  return map_of(width, height, states);
}

// Rounded to 1/256 cell, capped; of a cell of the map, which may lie outside it.
std::uint16_t brute_distance(const OccupancyMap& map, CellIndex from, std::uint32_t radius) {
  double sq = std::numeric_limits<double>::infinity();
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      if (map.at({x, y}) != CellState::kOccupied) continue;
      const double dx = x - from.x;
      const double dy = y - from.y;
      sq = std::min(sq, dx * dx + dy * dy);
    }
  }
  return static_cast<std::uint16_t>(std::lround(256.0 * std::min(std::sqrt(sq), static_cast<double>(radius))));
}

void expect_brute(const OccupancyMap& map, std::uint32_t radius, std::int32_t band_rows) {
  const DistanceFieldFile field = obstacle_field(map, radius, band_rows);
  const GridGeometry& grid = field.geometry;
  ASSERT_FALSE(field.cells.empty());
  EXPECT_EQ(field.cap, 256 * radius);
  const CellIndex corner{
      static_cast<std::int32_t>(std::lround((grid.origin_x_m - map.geometry.origin_x_m) / grid.resolution_m)),
      static_cast<std::int32_t>(std::lround((grid.origin_y_m - map.geometry.origin_y_m) / grid.resolution_m))};
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x) {
      ASSERT_EQ(field.view().at({x, y}), brute_distance(map, {corner.x + x, corner.y + y}, radius))
          << x << ", " << y << " with radius " << radius << " in bands of " << band_rows;
    }
  }
  // Nothing nearer than the cap was left out: around the field all is far.
  for (std::int32_t y = -1; y <= grid.height; ++y) {
    for (const std::int32_t x : {-1, 0, 1, grid.width - 2, grid.width - 1, grid.width}) {
      ASSERT_EQ(brute_distance(map, {corner.x + x, corner.y + y}, radius), field.cap);
    }
  }
  for (std::int32_t x = -1; x <= grid.width; ++x) {
    for (const std::int32_t y : {-1, 0, 1, grid.height - 2, grid.height - 1, grid.height}) {
      ASSERT_EQ(brute_distance(map, {corner.x + x, corner.y + y}, radius), field.cap);
    }
  }
}

TEST(ObstacleField, IsTheDistanceToTheNearestOccupiedCell) {
  for (const std::int32_t band : {1, 7, 64, kObstacleFieldBand}) {
    expect_brute(sprinkled(37, 53, 0.004, 1), 9, band);
    expect_brute(sprinkled(53, 37, 0.05, 2), 4, band);
  }
}

TEST(ObstacleField, SingleCellsAndEdges) {
  using enum CellState;
  expect_brute(map_of(1, 1, {kOccupied}), 5, 3);
  expect_brute(map_of(3, 1, {kOccupied, kUnknown, kUnknown}), 255, 100);
  std::vector<CellState> corners(11 * 13, kFree);
  corners.front() = kOccupied;
  corners.back() = kOccupied;
  expect_brute(map_of(11, 13, corners), 6, 5);
}

TEST(ObstacleField, NoCellsWhereNoneIsOccupied) {
  using enum CellState;
  const DistanceFieldFile field = obstacle_field(map_of(2, 2, {kFree, kUnknown, kFree, kFree}), 5);
  EXPECT_TRUE(field.cells.empty());
  EXPECT_EQ(field.cap, 5 * 256);
}

TEST(ObstacleField, TooManyCellsAreRefused) {
  // Its margin makes the field of a long line more than 2^29 cells.
  OccupancyMap map;
  map.geometry = {0.05, 0.0, 0.0, 1, 1'100'000};
  map.cells = CellStates(map.geometry.cell_count());
  map.cells.set(0, CellState::kOccupied);
  map.cells.set(map.geometry.cell_count() - 1, CellState::kOccupied);
  try {
    static_cast<void>(obstacle_field(map, 255));
    FAIL() << "made a field of 564 million cells";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("513 x 1100512 cells would be too large"));
  }
}

}  // namespace
}  // namespace gdtslam
