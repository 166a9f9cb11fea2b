// Walls that are seen from a pose, by a beam-free definition; moments of closing loops as shapes, without pixels.
#include "engine/drawing/maps/loops_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "engine/drawing/maps/seen_walls.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

/// Whether the straight line to a point of a cell meets anything before that cell, by many points along it.
bool is_hidden(const OccupancyMap& map, const Point2& from_m, const Point2& to_m) {
  constexpr int kPoints = 4000;
  const CellIndex end = map.geometry.cell_at(to_m);
  for (int k = 0; k <= kPoints; ++k) {
    const CellIndex cell = map.geometry.cell_at(from_m + static_cast<double>(k) / kPoints * (to_m - from_m));
    if (cell == end) return false;
    if (map.at(cell) != CellState::kFree) return true;
  }
  return false;
}

/// How many of some points along the borders of a cell are in sight.
int points_in_sight(const OccupancyMap& map, const Point2& from_m, CellIndex cell) {
  constexpr int kSide = 8;
  const double half_m = 0.499 * map.geometry.resolution_m;
  int count = 0;
  for (int k = 0; k <= kSide; ++k) {
    const double along_m = (2.0 * k / kSide - 1.0) * half_m;
    for (const Point2& at :
         {Point2(along_m, half_m), Point2(along_m, -half_m), Point2(half_m, along_m), Point2(-half_m, along_m)}) {
      count += is_hidden(map, from_m, map.geometry.cell_centre(cell) + at) ? 0 : 1;
    }
  }
  return count;
}

TEST(SeenWalls, AreThoseThatNoOtherWallHides) {
  const OccupancyMap map = two_rooms();
  const Pose2 T_map_pose{-0.7, 0.33, 0.7};
  const std::vector<Point2> seen = picture::walls_seen_from(map, T_map_pose, 10.0, 3600);
  std::size_t found = 0;
  for (const CellIndex cell : obstacles_of(map)) {
    const Point2 middle = map.geometry.cell_centre(cell);
    const bool is_seen = std::any_of(seen.begin(), seen.end(),
                                     [&](const Point2& at) { return ((T_map_pose * at) - middle).norm() < 1e-9; });
    const int in_sight = points_in_sight(map, T_map_pose.translation(), cell);
    EXPECT_TRUE(!is_seen || in_sight > 0) << cell.x << ' ' << cell.y;
    EXPECT_TRUE(is_seen || in_sight < 9) << cell.x << ' ' << cell.y;
    found += is_seen ? 1U : 0U;
  }
  EXPECT_EQ(found, seen.size()) << "walls that the map does not have";
  EXPECT_GT(found, 60U);
}

TEST(SeenWalls, EndAtTheReachAndAtWhatIsUnknown) {
  const OccupancyMap map = two_rooms();
  const Pose2 pose{-1.0, 0.5, 0.0};
  for (const Point2& wall : picture::walls_seen_from(map, pose, 1.5, 720)) EXPECT_LT(wall.norm(), 1.5 + 0.1);
  EXPECT_TRUE(picture::walls_seen_from(map, {100.0, 0.0, 0.0}, 10.0, 360).empty());
  EXPECT_TRUE(picture::walls_seen_from(map, {std::nan(""), 0.0, 0.0}, 10.0, 360).empty());
  OccupancyMap dark = map;
  for (std::size_t cell = 0; cell < dark.cells.size(); ++cell) {
    if (dark.cells[cell] == CellState::kFree) dark.cells.set(cell, CellState::kUnknown);
  }
  EXPECT_TRUE(picture::walls_seen_from(dark, pose, 10.0, 360).empty());
}

class LoopsMoments : public testing::Test {
 protected:
  LoopsMoments() {
    scene_.map = &map_;
    scene_.extent = round_trip().trajectory;
    scene_.has_loops_on = scene_.has_loops_off = true;
    scene_.largest_sigma_m = 0.2;
    for (const StampedPose& pose : scene_.extent) moment_.path_m.push_back(pose.T_map_base.translation());
    moment_.walls_m = {{0.0, 0.0}, {1.0, 1.0}};
    moment_.loops = {{.from_m = {0.0, 0.0}, .to_m = {2.0, 1.0}, .weight = 1.0, .is_on = true, .glow = 0.0},
                     {.from_m = {0.5, 0.0}, .to_m = {2.0, 0.5}, .weight = 0.1, .is_on = false, .glow = 0.0}};
    moment_.robot_m = Point2(2.0, 1.0);
    moment_.robot_covariance = {.xx = 0.04, .yy = 0.01};
  }
  [[nodiscard]] Canvas drawn() const {
    MapLook look;
    look.title = "t";
    look.subtitle = "s";
    return loops_picture(scene_, moment_, look, {1600, 1200});
  }

  OccupancyMap map_ = two_rooms();
  LoopsScene scene_;
  LoopsMoment moment_;
};

TEST_F(LoopsMoments, LegendIsTheSameWhateverTheMoment) {
  const auto legend = [this] {
    std::vector<std::pair<std::string, double>> words;
    for (const shape::Words& one : shapes_of<shape::Words>(drawn())) words.emplace_back(one.text, one.at.y());
    return words;
  };
  const auto all = legend();
  moment_.loops.clear();
  moment_.robot_m.reset();
  moment_.map_share = 1.0;
  EXPECT_EQ(legend(), all);
  EXPECT_TRUE(says(drawn(), "loop switched off"));
  EXPECT_TRUE(says(drawn(), "3 sigma"));
  scene_.has_loops_off = false;
  scene_.largest_sigma_m = 0.0;
  EXPECT_FALSE(says(drawn(), "switched off"));
  EXPECT_FALSE(says(drawn(), "sigma"));
}

TEST_F(LoopsMoments, ALoopThatWasJustFoundGlowsUntilItDoesNot) {
  const auto widest = [this] {
    double width = 0.0;
    for (const shape::Line& line : shapes_of<shape::Line>(drawn())) width = std::max(width, line.pen.width);
    return width;
  };
  const double calm = widest();
  moment_.loops[0].glow = 1.0;
  EXPECT_GT(widest(), 2.0 * calm);
  moment_.loops[0].glow = 0.0;
  EXPECT_EQ(widest(), calm);
}

TEST_F(LoopsMoments, WallsGiveWayToTheMap) {
  const auto pictures = [this] { return shapes_of<shape::Picture>(drawn()).size(); };
  EXPECT_EQ(pictures(), 1U) << "walls alone";
  moment_.map_share = 0.5;
  EXPECT_EQ(pictures(), 2U) << "both";
  moment_.map_share = 1.0;
  EXPECT_EQ(pictures(), 1U) << "the map alone";
}

TEST_F(LoopsMoments, WhatIsNotFiniteIsLeftOut) {
  const double bad = std::nan("");
  moment_.path_m.emplace_back(bad, 0.0);
  moment_.walls_m.emplace_back(0.0, 1e300);
  moment_.loops.push_back({.from_m = {bad, bad}, .to_m = {0.0, 0.0}, .weight = 1.0, .is_on = true, .glow = 1.0});
  moment_.robot_covariance.xx = bad;
  for (const shape::Line& line : shapes_of<shape::Line>(drawn())) {
    for (const Point2& point : line.points) EXPECT_TRUE(std::isfinite(point.x()) && std::isfinite(point.y()));
  }
}

}  // namespace
}  // namespace gdtslam
