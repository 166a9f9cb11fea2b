// What is new and gone in a map, in rooms whose walls are segments: expected cells come from the segments.
#include "engine/mapping/changes/map_changes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "engine/mapping/changes/session_changes.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

using test::Segment;
using Walls = std::vector<Segment>;

constexpr double kRoomCell_m = 0.025;
constexpr double kNear_m = 0.06;  // noise of three sigmas, and a cell

void add_box(Walls& walls, const Point2& low, const Point2& high) {
  walls.push_back({low, {high.x(), low.y()}});
  walls.push_back({{high.x(), low.y()}, high});
  walls.push_back({high, {low.x(), high.y()}});
  walls.push_back({{low.x(), high.y()}, low});
}

Walls box(const Point2& low, const Point2& high) {
  Walls walls;
  add_box(walls, low, high);
  return walls;
}

Walls room_with(const Walls& more) {
  Walls walls = box({0.01, 0.01}, {8.01, 6.01});
  walls.insert(walls.end(), more.begin(), more.end());
  return walls;
}

const Walls kOldBox = box({2.51, 2.61}, {3.11, 3.31});
const Walls kNewBox = box({5.01, 2.71}, {5.61, 3.21});

/// Twice around the room, a step each 8 cm, looking ahead.
std::vector<Pose2> laps() {
  std::vector<Pose2> poses;
  const std::vector<Point2> corners{{1.3, 1.3}, {6.7, 1.3}, {6.7, 4.7}, {1.3, 4.7}, {1.3, 1.3}};
  for (int lap = 0; lap < 2; ++lap) {
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      const Point2 way = corners[k + 1] - corners[k];
      const auto steps = static_cast<int>(way.norm() / 0.08);
      for (int i = 0; i < steps; ++i) {
        const Point2 at = corners[k] + way * (static_cast<double>(i) / steps);
        poses.push_back({at.x(), at.y(), std::atan2(way.y(), way.x())});
      }
    }
  }
  return poses;
}

/// The walls at the k-th scan of a drive.
using World = std::function<Walls(std::size_t)>;

World standing(const Walls& walls) {
  return [walls](std::size_t) { return walls; };
}

/// A drive with noise of 1 cm in ranges, and of 5 mm and 0.1 degrees in the poses that are believed.
void drive_through(const World& world, std::uint64_t seed,
                   const std::function<void(const LaserScan&, const Pose2&)>& take) {
  Random random(seed);
  const std::vector<Pose2> poses = laps();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    LaserScan scan = test::scan_of(world(k), poses[k], 0.1 * static_cast<double>(k), 361);
    for (float& range : scan.ranges_m) range += static_cast<float>(0.01 * random.normal());
    take(scan, poses[k] * Pose2{0.005 * random.normal(), 0.005 * random.normal(), 0.0017 * random.normal()});
  }
}

OccupancyMap map_of(const Walls& walls) {
  OccupancyBuilder builder({}, {.resolution_m = kRoomCell_m});
  drive_through(standing(walls), 1, [&](const LaserScan& scan, const Pose2& pose) { builder.add(scan, pose); });
  return builder.build();
}

ViewCounts counts() {
  return ViewCounts({.rays = {.resolution_m = kRoomCell_m,
                              .min_range_m = 0.1,
                              .max_range_m = 40.0,
                              .short_of_end_m = ChangeLimits{}.tolerance_m},
                     .spacing_m = ChangeLimits{}.spacing_m});
}

MapChanges changes_in(const OccupancyMap& map, const World& world) {
  ViewCounts views = counts();
  drive_through(world, 2, [&](const LaserScan& scan, Pose2 pose) {
    pose.x_m -= map.geometry.origin_x_m;
    pose.y_m -= map.geometry.origin_y_m;
    views.add(scan, pose);
  });
  return find_changes(map, views, nullptr, {});
}

double distance_m(const Segment& segment, const Point2& point) {
  const Point2 along = segment.to - segment.from;
  const double share = std::clamp((point - segment.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (segment.from + share * along - point).norm();
}

/// All cells lie on the walls, and cells lie on most of the walls.
void expect_on(const Walls& walls, const std::vector<ChangedCell>& cells, const GridGeometry& grid) {
  ASSERT_FALSE(cells.empty());
  for (const ChangedCell& changed : cells) {
    const Point2 at = grid.cell_centre(changed.cell);
    double nearest_m = 100.0;
    for (const Segment& wall : walls) nearest_m = std::min(nearest_m, distance_m(wall, at));
    EXPECT_LT(nearest_m, kNear_m) << at.transpose();
  }
  std::size_t covered = 0;
  std::size_t places = 0;
  for (const Segment& wall : walls) {
    for (double share = 0.05; share < 1.0; share += 0.1) {
      const Point2 at = wall.from + share * (wall.to - wall.from);
      ++places;
      covered += std::any_of(cells.begin(), cells.end(), [&](const ChangedCell& changed) {
        return (grid.cell_centre(changed.cell) - at).norm() < kNear_m;
      });
    }
  }
  EXPECT_GT(static_cast<double>(covered), 0.9 * static_cast<double>(places));
}

TEST(MapChanges, ABoxThatWasMovedIsGoneHereAndNewThere) {
  const OccupancyMap map = map_of(room_with(kOldBox));
  const MapChanges changes = changes_in(map, standing(room_with(kNewBox)));
  expect_on(kNewBox, changes.appeared, map.geometry);
  expect_on(kOldBox, changes.gone, map.geometry);
  EXPECT_EQ(count_patches(changes.appeared), 1U);
  EXPECT_EQ(count_patches(changes.gone), 1U);
  for (const ChangedCell& changed : changes.gone) EXPECT_GE(changed.views.passes, ChangeLimits{}.least_views);
}

TEST(MapChanges, ADoorThatOpensIsGone) {
  const Segment left{{4.0, 0.01}, {4.0, 2.5}};
  const Segment door{{4.0, 2.5}, {4.0, 3.5}};
  const Segment right{{4.0, 3.5}, {4.0, 3.9}};
  const OccupancyMap map = map_of(room_with({left, door, right}));
  const MapChanges changes = changes_in(map, standing(room_with({left, right})));
  EXPECT_TRUE(changes.appeared.empty());
  ASSERT_FALSE(changes.gone.empty());
  for (const ChangedCell& changed : changes.gone) {
    EXPECT_LT(distance_m(door, map.geometry.cell_centre(changed.cell)), kNear_m);
  }
}

TEST(MapChanges, NothingChangedNothingIsTold) {
  const OccupancyMap map = map_of(room_with(kOldBox));
  EXPECT_TRUE(changes_in(map, standing(room_with(kOldBox))).empty());
}

TEST(MapChanges, WhoeverWalksByIsNotTold) {
  const OccupancyMap map = map_of(room_with({}));
  const World walking = [](std::size_t k) {
    const double along = std::fmod(0.11 * static_cast<double>(k), 4.0);
    return room_with(box({2.0 + along, 2.9}, {2.3 + along, 3.2}));
  };
  EXPECT_TRUE(changes_in(map, walking).empty());
}

TEST(MapChanges, LoneReturnsAreNotTold) {
  const OccupancyMap map = map_of(room_with({}));
  const World flickering = [](std::size_t k) { return k % 40 == 7 ? room_with(kNewBox) : room_with({}); };
  EXPECT_TRUE(changes_in(map, flickering).empty());
}

TEST(MapChanges, GlassIsNeitherNewNorGone) {
  const World glass = [](std::size_t k) { return k % 10 < 3 ? room_with(kNewBox) : room_with({}); };
  EXPECT_TRUE(changes_in(map_of(room_with({})), glass).empty());
  EXPECT_TRUE(changes_in(map_of(room_with(kNewBox)), glass).empty());
}

TEST(MapChanges, ARobotThatStandsHasOneView) {
  ViewCounts views = counts();
  const LaserScan scan = test::scan_of(room_with(kNewBox), {3.5, 3.0, 0.0}, 0.0);
  for (int k = 0; k < 100; ++k) views.add(scan, {3.5, 3.0, 0.0});
  EXPECT_EQ(views.views(), 1U);
}

DriveViews drive_of(const Walls& walls, std::uint64_t seed, double first_s, double last_s) {
  DriveViews drive{counts(), first_s, last_s};
  drive_through(standing(walls), seed, [&](const LaserScan& scan, const Pose2& pose) { drive.views.add(scan, pose); });
  return drive;
}

GridGeometry frame() { return {.resolution_m = kRoomCell_m}; }

TEST(SessionChanges, TheLaterDriveOverrulesWhateverTheirOrder) {
  for (const bool is_swapped : {false, true}) {
    std::vector<DriveViews> drives;
    drives.push_back(drive_of(room_with(kOldBox), 3, 0.0, 10.0));
    drives.push_back(drive_of(room_with(kNewBox), 4, 20.0, 30.0));
    if (is_swapped) std::swap(drives[0], drives[1]);
    const SessionChanges found(drives, kRoomCell_m, {});
    const std::size_t earlier = is_swapped ? 1 : 0;
    expect_on(kNewBox, found.last().appeared, frame());
    expect_on(kOldBox, found.last().gone, frame());
    EXPECT_TRUE(found.by_drive()[earlier].empty());
    EXPECT_EQ(found.by_drive()[1 - earlier].gone.size(), found.last().gone.size());
    for (const ChangedCell& gone : found.last().gone) {
      EXPECT_TRUE(found.is_overruled(earlier, gone.cell));
      EXPECT_FALSE(found.is_overruled(1 - earlier, gone.cell));
    }
  }
}

TEST(SessionChanges, WithoutAnOrderNeitherIsAWall) {
  std::vector<DriveViews> drives;
  drives.push_back(drive_of(room_with(kOldBox), 3, 0.0, 10.0));
  drives.push_back(drive_of(room_with(kNewBox), 4, 5.0, 15.0));
  const SessionChanges found(drives, kRoomCell_m, {});
  EXPECT_TRUE(found.last().appeared.empty());
  Walls both = kOldBox;
  both.insert(both.end(), kNewBox.begin(), kNewBox.end());
  expect_on(both, found.last().gone, frame());
  EXPECT_EQ(count_patches(found.last().gone), 2U);
}

TEST(SessionChanges, WhatCameBackStays) {
  std::vector<DriveViews> drives;
  drives.push_back(drive_of(room_with(kOldBox), 3, 0.0, 10.0));
  drives.push_back(drive_of(room_with({}), 4, 20.0, 30.0));
  drives.push_back(drive_of(room_with(kOldBox), 5, 40.0, 50.0));
  const SessionChanges found(drives, kRoomCell_m, {});
  EXPECT_FALSE(found.by_drive()[1].gone.empty());
  expect_on(kOldBox, found.last().appeared, frame());
  for (const ChangedCell& stays : found.last().appeared) {
    EXPECT_FALSE(found.is_overruled(0, stays.cell));
    EXPECT_FALSE(found.is_overruled(2, stays.cell));
  }
}

}  // namespace
}  // namespace gdtslam
