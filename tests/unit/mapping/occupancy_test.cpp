// Expected cells come from geometry done by hand, or from a brute-force oracle that clips the beam against every cell.
#include "gdtslam/mapping/occupancy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
const OccupancyConfig kOneEnd{.min_ends = 1};
const OccupancyBuilder::Limits kUnitCells{.resolution_m = 1.0, .min_range_m = 0.1, .max_range_m = 40.0};

LaserScan scan_of(std::vector<float> ranges_m, double first_rad = 0.0, double step_rad = 0.0) {
  return {.stamp_s = 0.0,
          .first_bearing_rad = first_rad,
          .bearing_step_rad = step_rad,
          .max_range_m = 0.0,
          .ranges_m = std::move(ranges_m),
          .T_base_laser = {}};
}

// '#' occupied, '.' free, ' ' unknown; the row with the highest y first.
std::vector<std::string> picture(const OccupancyMap& map) {
  std::vector<std::string> rows;
  for (std::int32_t y = map.geometry.height - 1; y >= 0; --y) {
    std::string row;
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      const CellState state = map.at({x, y});
      row += state == CellState::kOccupied ? '#' : state == CellState::kFree ? '.' : ' ';
    }
    rows.push_back(row);
  }
  return rows;
}

using Picture = std::vector<std::string>;

TEST(Occupancy, NothingSeenIsOneUnknownCell) {
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  EXPECT_EQ(picture(builder.build()), (Picture{" "}));
  builder.add(scan_of({kInf, kNan, 0.05F, 50.0F}), {});
  EXPECT_EQ(picture(builder.build()), (Picture{" "}));
}

TEST(Occupancy, StraightBeamsInEveryDirection) {
  // From the centre of cell (0, 0), four beams of 2 m: right, up, left, down.
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  builder.add(scan_of({2.0F, 2.0F, 2.0F, 2.0F}, 0.0, kPi / 2), {0.5, 0.5, 0.0});
  const OccupancyMap map = builder.build();
  EXPECT_EQ(picture(map), (Picture{"  #  ", "  .  ", "#...#", "  .  ", "  #  "}));
  EXPECT_EQ(map.geometry, (GridGeometry{1.0, -2.0, -2.0, 5, 5}));
}

TEST(Occupancy, SlantedBeamCrossesTheCellsItCrosses) {
  // From (0.5, 0.5) to (3.5, 2.0 - 1/8): x borders 1, 2, 3 at y = 0.729, 1.1875, 1.646, so y = 1 is crossed in x
  // cell 1.
  const double dx = 3.0;
  const double dy = 1.375;
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  builder.add(scan_of({static_cast<float>(std::sqrt(dx * dx + dy * dy))}, std::atan2(dy, dx)), {0.5, 0.5, 0.0});
  EXPECT_EQ(picture(builder.build()), (Picture{" ..#", "..  "}));
}

TEST(Occupancy, PoseAndMountMoveTheBeam) {
  // The laser is 1 m ahead of the robot and turned right by 90 degrees; the robot looks up from (0.5, 0.5): the laser
  // is at (0.5, 1.5) and its beam goes right.
  LaserScan scan = scan_of({2.0F});
  scan.T_base_laser = {1.0, 0.0, -kPi / 2};
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  builder.add(scan, {0.5, 0.5, kPi / 2});
  const OccupancyMap map = builder.build();
  EXPECT_EQ(picture(map), (Picture{"..#"}));
  EXPECT_EQ(map.geometry.origin_y_m, 1.0);
}

TEST(Occupancy, BeamsWithoutReturnClearOnlyUpToTheStatedLength) {
  for (const float no_return : {kInf, kNan, 50.0F}) {
    OccupancyBuilder silent(kOneEnd, kUnitCells);
    silent.add(scan_of({no_return, 1.0F}, 0.0, kPi / 2), {0.5, 0.5, 0.0});
    EXPECT_EQ(picture(silent.build()), (Picture{"#", "."})) << no_return;
    OccupancyBuilder clearing({.min_ends = 1, .no_return_free_m = 2.0}, kUnitCells);
    clearing.add(scan_of({no_return, 1.0F}, 0.0, kPi / 2), {0.5, 0.5, 0.0});
    EXPECT_EQ(picture(clearing.build()), (Picture{"#  ", "..."})) << no_return;
  }
}

TEST(Occupancy, SensorLimitOfTheLogCountsToo) {
  LaserScan scan = scan_of({5.0F});
  scan.max_range_m = 5.0;
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  builder.add(scan, {0.5, 0.5, 0.0});
  EXPECT_EQ(picture(builder.build()), (Picture{" "}));
}

TEST(Occupancy, AnEndBeatsAPassWithinOneScan) {
  // Both beams lie in one row; the first ends in the third cell, the second passes it, whatever their order.
  for (const std::vector<float>& ranges : {std::vector{2.0F, 4.0F}, std::vector{4.0F, 2.0F}}) {
    OccupancyBuilder builder({.occupied_share = 1.0, .min_ends = 1}, kUnitCells);
    builder.add(scan_of(ranges), {0.5, 0.5, 0.0});
    EXPECT_EQ(picture(builder.build()), (Picture{"..#.#"}));
  }
}

TEST(Occupancy, ShareAndNumberOfScansDecide) {
  // The cell at 2 m is an end in 3 scans and passed by k more: occupied while 3 / (3 + k) >= 1/4, so up to k = 9.
  OccupancyBuilder builder({.occupied_share = 0.25, .min_ends = 3}, kUnitCells);
  const auto see = [&builder](float range_m) { builder.add(scan_of({range_m}), {0.5, 0.5, 0.0}); };
  see(2.0F);
  EXPECT_EQ(picture(builder.build()), (Picture{".."}));  // too few ends: not occupied, and nothing passed through it
  see(2.0F);
  see(2.0F);
  EXPECT_EQ(picture(builder.build()), (Picture{"..#"}));
  for (int k = 0; k < 9; ++k) see(3.0F);
  EXPECT_EQ(picture(builder.build()), (Picture{"..##"}));
  see(3.0F);
  EXPECT_EQ(picture(builder.build()), (Picture{"...#"}));
}

TEST(Occupancy, FullCountersKeepTheirRatio) {
  // 80,000 ends and 120,000 passes are more than the counters' 16 bits hold; the share is 0.4 all the same.
  const auto occupied_at = [](double share) {
    OccupancyBuilder builder({.occupied_share = share}, kUnitCells);
    for (int k = 0; k < 40000; ++k) {
      for (const float range_m : {2.0F, 3.0F, 3.0F, 2.0F, 3.0F}) builder.add(scan_of({range_m}), {0.5, 0.5, 0.0});
    }
    return builder.build().at({2, 0}) == CellState::kOccupied;
  };
  EXPECT_TRUE(occupied_at(0.39));
  EXPECT_FALSE(occupied_at(0.41));
}

TEST(Occupancy, GridGrowsWithoutForgetting) {
  OccupancyBuilder builder(kOneEnd, kUnitCells);
  const Pose2 poses[] = {{0.5, 0.5, 0.0}, {-300.5, 0.5, 0.0}, {0.5, 200.5, 0.0}, {250.5, -99.5, 0.0}};
  for (const Pose2& pose : poses) builder.add(scan_of({2.0F}), pose);
  const OccupancyMap map = builder.build();
  for (const Pose2& pose : poses) {
    const CellIndex cell = map.geometry.cell_at(pose.translation());
    EXPECT_EQ(map.at(cell), CellState::kFree);
    EXPECT_EQ(map.at(cell + CellOffset{2, 0}), CellState::kOccupied);
  }
  EXPECT_EQ(map.geometry, (GridGeometry{1.0, -301.0, -100.0, 554, 301}));
}

// Of a map in unit cells that keeps so many tiles of 64 x 64 cells.
OccupancyBuilder::Limits limits_of(std::uint64_t tiles) {
  return {.resolution_m = 1.0, .min_range_m = 0.1, .max_range_m = 40.0, .max_cells = 4096 * tiles};
}

TEST(Occupancy, RefusesToGrowBeyondTheLimitAndStaysAsItWas) {
  OccupancyBuilder builder(kOneEnd, limits_of(1));
  builder.add(scan_of({2.0F}), {0.5, 0.5, 0.0});
  const Picture before = picture(builder.build());
  EXPECT_THROW(builder.add(scan_of({2.0F}), {200.5, 0.5, 0.0}), InputError);
  EXPECT_THROW(builder.add(scan_of({2.0F, 2.0F}, 0.0, kPi), {0.5, 0.5, 0.0}), InputError);
  EXPECT_THROW(builder.add(scan_of({2.0F}), {1e300, -1e300, 0.0}), InputError);
  EXPECT_THROW(builder.add(scan_of({2.0F}), {std::nan(""), 0.0, 0.0}), InputError);
  EXPECT_EQ(picture(builder.build()), before);
  builder.add(scan_of({3.0F}), {0.5, 0.5, 0.0});
  EXPECT_EQ(picture(builder.build()), (Picture{"..##"}));
}

// What lies between the tiles is not kept, but the finished map has it: four cells for each that is kept.
TEST(Occupancy, LimitsTheRectangleAroundTheMapToo) {
  OccupancyBuilder builder(kOneEnd, limits_of(2));
  builder.add(scan_of({2.0F}), {0.5, 0.5, 0.0});
  EXPECT_THROW(builder.add(scan_of({2.0F}), {200.5, 200.5, 0.0}), InputError);
  builder.add(scan_of({2.0F}), {20000.5, 0.5, 0.0});
  EXPECT_EQ(builder.build().geometry, (GridGeometry{1.0, 0.0, 0.0, 20003, 1}));
}

TEST(Occupancy, UpToTheLimitTheMapIsWhatItIsWithoutOne) {
  OccupancyBuilder tight(kOneEnd, limits_of(5));
  OccupancyBuilder unbounded(kOneEnd, kUnitCells);
  for (const Pose2& pose : {Pose2{0.5, 0.5, 0.0}, Pose2{150.5, 0.5, 0.0}, Pose2{0.5, 150.5, 0.0},
                            Pose2{300.5, 100.5, 0.0}, Pose2{200.5, 200.5, 0.0}}) {
    tight.add(scan_of({2.0F}), pose);
    unbounded.add(scan_of({2.0F}), pose);
    EXPECT_EQ(picture(tight.build()), picture(unbounded.build()));
  }
  EXPECT_THROW(tight.add(scan_of({2.0F}), {301.5, 0.5, 0.0}), InputError);
}

TEST(OccupancyOptions, PointIntoTheConfiguration) {
  OccupancyConfig config;
  const std::vector<Option> table = option_table(config);
  ASSERT_EQ(table.size(), 3u);
  *std::get<double*>(table[0].value) = 0.5;
  *std::get<std::int32_t*>(table[1].value) = 7;
  *std::get<double*>(table[2].value) = 3.0;
  EXPECT_EQ(config.occupied_share, 0.5);
  EXPECT_EQ(config.min_ends, 7);
  EXPECT_EQ(config.no_return_free_m, 3.0);
}

}  // namespace
}  // namespace gdtslam
