// Floors and ceilings of rooms that a program made, with noise, furniture, windows and parts missing.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/runs/drive/cloud_sample.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

/// Points on rectangles, as dense as `per_m2` says, with noise in all directions.
class RoomMaker {
 public:
  explicit RoomMaker(double sigma_m, std::uint64_t seed) : sigma_m_(sigma_m), random_(seed) {}

  void rectangle(const Point3& corner, const Point3& a, const Point3& b, double per_m2) {
    const auto count = static_cast<int>(per_m2 * a.cross(b).norm());
    for (int k = 0; k < count; ++k) add(corner + random_.uniform() * a + random_.uniform() * b);
  }
  void level(double x, double y, double z, double dx, double dy, double per_m2) {
    rectangle({x, y, z}, {dx, 0, 0}, {0, dy, 0}, per_m2);
  }
  /// Four walls of a room whose corner is the origin.
  void walls(double dx, double dy, double from_z, double to_z, double per_m2) {
    const Point3 up(0, 0, to_z - from_z);
    for (const double y : {0.0, dy}) rectangle({0, y, from_z}, {dx, 0, 0}, up, per_m2);
    for (const double x : {0.0, dx}) rectangle({x, 0, from_z}, {0, dy, 0}, up, per_m2);
  }
  /// Table: top and the sides of a cabinet below.
  void box(double x, double y, double dx, double dy, double height, double per_m2) {
    level(x, y, height, dx, dy, per_m2);
    for (const double at : {0.0, dy}) rectangle({x, y + at, 0}, {dx, 0, 0}, {0, 0, height}, per_m2);
  }
  void add(const Point3& p) {
    const Point3 q = T_ * (p + sigma_m_ * Point3(random_.normal(), random_.normal(), random_.normal()));
    cloud.push_back(
        {.x_m = static_cast<float>(q.x()), .y_m = static_cast<float>(q.y()), .z_m = static_cast<float>(q.z())});
  }
  /// Turns what follows about the y axis, upwards along x.
  void tilt(double angle_rad) { T_ = Eigen::AngleAxisd(-angle_rad, Point3::UnitY()).toRotationMatrix(); }

  Cloud cloud;

 private:
  double sigma_m_;
  Random random_;
  Eigen::Matrix3d T_ = Eigen::Matrix3d::Identity();
};

constexpr double kCeiling_m = 2.6;

void expect_level(const std::optional<PlanePatch>& patch, double height_m, const Point3& normal = {0, 0, 1}) {
  ASSERT_TRUE(patch.has_value());
  EXPECT_NEAR(patch->centre.dot(normal), height_m, 0.003);
  EXPECT_NEAR(patch->plane.normal.dot(normal), 1.0, 1e-5);
  EXPECT_LT(patch->rms_m, 0.02);
}

TEST(LevelSurfaces, FurnishedRoomsWithNoise) {
  for (const double sigma_m : {0.0, 0.005, 0.01, 0.015}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      RoomMaker room(sigma_m, seed);
      room.level(0, 0, 0, 5, 4, 500);
      room.level(0, 0, kCeiling_m, 5, 4, 500);
      room.walls(5, 4, 0, kCeiling_m, 1500);  // walls are hit from nearer than the floor
      room.box(0.5, 0.5, 1.6, 0.8, 0.75, 2000);
      room.box(3, 2, 1.2, 0.6, 0.72, 2000);
      room.box(0.2, 3, 0.5, 0.8, 2.0, 500);
      const LevelSurfaces found = find_level_surfaces(room.cloud, {});
      expect_level(found.floor, 0.0);
      expect_level(found.ceiling, kCeiling_m);
    }
  }
}

TEST(LevelSurfaces, HeightsAreNotFixed) {
  RoomMaker room(0.01, 3);
  room.level(-50, 80, -3.7, 6, 6, 300);
  room.level(-50, 80, 5.1, 6, 6, 300);
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  expect_level(found.floor, -3.7);
  expect_level(found.ceiling, 5.1);
}

TEST(LevelSurfaces, WhatAWindowShowsLiesBeyond) {
  RoomMaker room(0.01, 4);
  room.level(0, 0, 0, 5, 4, 500);
  room.level(0, 0, kCeiling_m, 5, 4, 500);
  room.walls(5, 4, 0, kCeiling_m, 800);
  room.rectangle({6, 0, -4}, {14, 0, -3}, {0, 10, 0}, 5);  // a slope outside, few points over a wide ground
  room.rectangle({20, 0, -5}, {0, 10, 0}, {0, 0, 12}, 5);  // and a house
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  expect_level(found.floor, 0.0);
  expect_level(found.ceiling, kCeiling_m);
}

TEST(LevelSurfaces, MissingOnesAreNone) {
  for (const bool has_floor : {false, true}) {
    RoomMaker room(0.01, 5);
    room.level(0, 0, has_floor ? 0 : kCeiling_m, 5, 4, 500);
    room.walls(5, 4, 0.1, 2.4, 800);
    room.box(0.5, 0.5, 1.6, 0.8, 0.75, 1000);
    const LevelSurfaces found = find_level_surfaces(room.cloud, {});
    EXPECT_EQ(found.floor.has_value(), has_floor);
    EXPECT_EQ(found.ceiling.has_value(), !has_floor);
  }
}

TEST(LevelSurfaces, OnlyWallsHaveNeither) {
  RoomMaker room(0.01, 6);
  room.walls(5, 4, 0.3, 2.2, 800);
  // A scan that stays level draws one row along all walls, at their lower edge.
  for (int k = 0; k < 20000; ++k) room.add({5.0 * (k % 1000) / 1000.0, k % 2 == 0 ? 0.0 : 4.0, 0.3});
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  EXPECT_FALSE(found.floor.has_value());
  EXPECT_FALSE(found.ceiling.has_value());
}

TEST(LevelSurfaces, TiltedByTwoDegreesIsStillLevel) {
  const double tilt_rad = 2.0 * 3.14159265358979 / 180.0;
  for (const double length_m : {5.0, 30.0}) {
    RoomMaker room(0.01, 7);
    room.tilt(tilt_rad);
    room.level(0, 0, 0, length_m, 2.5, 500);
    room.level(0, 0, kCeiling_m, length_m, 2.5, 500);
    room.walls(length_m, 2.5, 0, kCeiling_m, 800);
    const LevelSurfaces found = find_level_surfaces(room.cloud, {});
    const Point3 normal(-std::sin(tilt_rad), 0, std::cos(tilt_rad));
    expect_level(found.floor, 0.0, normal);
    expect_level(found.ceiling, kCeiling_m, normal);
  }
}

TEST(LevelSurfaces, ASlopeIsNeither) {
  RoomMaker room(0.01, 8);
  room.tilt(5.0 * 3.14159265358979 / 180.0);
  room.level(0, 0, 0, 20, 2.5, 500);
  room.level(0, 0, kCeiling_m, 20, 2.5, 500);
  room.walls(20, 2.5, 0, kCeiling_m, 500);
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  EXPECT_FALSE(found.floor.has_value());
  EXPECT_FALSE(found.ceiling.has_value());
  LevelSearch wider;
  wider.max_tilt_rad = 0.1;
  EXPECT_TRUE(find_level_surfaces(room.cloud, wider).floor.has_value());
}

TEST(LevelSurfaces, TheHigherOfTwoCeilingsCounts) {
  RoomMaker room(0.01, 9);
  room.level(0, 0, 0, 10, 4, 300);
  room.level(0, 0, 2.6, 7, 4, 300);
  room.level(7, 0, 4.0, 3, 4, 300);
  room.walls(10, 4, 0, 2.6, 300);
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  expect_level(found.floor, 0.0);
  expect_level(found.ceiling, 4.0);
}

TEST(LevelSurfaces, OpenGroundIsAFloor) {
  RoomMaker ground(0.01, 10);
  ground.level(0, 0, 0, 20, 20, 50);
  const LevelSurfaces found = find_level_surfaces(ground.cloud, {});
  expect_level(found.floor, 0.0);
  EXPECT_FALSE(found.ceiling.has_value());
}

TEST(LevelSurfaces, OneFarPointChangesNothing) {
  RoomMaker room(0.01, 11);
  room.level(0, 0, 0, 5, 4, 500);
  room.level(0, 0, kCeiling_m, 5, 4, 500);
  room.cloud.push_back({.x_m = -3e8F, .y_m = 3e30F, .z_m = 1e10F});
  const LevelSurfaces found = find_level_surfaces(room.cloud, {});
  expect_level(found.floor, 0.0);
  expect_level(found.ceiling, kCeiling_m);
}

TEST(LevelSurfaces, NothingAndNextToNothingHaveNeither) {
  Cloud line;
  for (int k = 0; k < 100; ++k) line.push_back({.x_m = static_cast<float>(k) * 0.1F});
  for (const Cloud& cloud : {Cloud{}, Cloud(1), Cloud(1000), line}) {
    const LevelSurfaces found = find_level_surfaces(cloud, {});
    EXPECT_FALSE(found.floor || found.ceiling);
  }
}

LevelSurfaces level_at(double floor_m, double ceiling_m, double sign) {
  PlanePatch floor;
  floor.plane = {{0, 0, sign}, sign * floor_m};
  PlanePatch ceiling;
  ceiling.plane = {{0, 0, sign}, sign * ceiling_m};
  return {floor, ceiling};
}

TEST(LevelRemoval, TakesFloorCeilingAndWhatLiesBeyond) {
  Cloud cloud;
  for (int k = 0; k < 60; ++k) cloud.push_back({.z_m = -1.0F + 0.0625F * static_cast<float>(k)});  // exact in binary
  for (const double sign : {1.0, -1.0}) {  // whichever way the normals point
    CloudKeeper keeper;
    LevelRemoval removal(level_at(-0.5, 2.0, sign), 0.125, keeper);
    removal.add(std::span(cloud).first(20));
    removal.add(std::span(cloud).subspan(20));
    Cloud expected;
    for (const CloudPoint& p : cloud) {
      if (p.z_m > -0.375F && p.z_m < 1.875F) expected.push_back(p);
    }
    EXPECT_EQ(keeper.cloud, expected);
    EXPECT_EQ(removal.removed(), cloud.size() - expected.size());
  }
  CloudKeeper keeper;
  LevelRemoval removal({}, 0.1, keeper);
  removal.add(cloud);
  EXPECT_EQ(keeper.cloud, cloud);
}

Cloud numbered(std::uint32_t count) {
  Cloud cloud(count);
  for (std::uint32_t k = 0; k < count; ++k) cloud[k].scan = k;
  return cloud;
}

TEST(CloudSample, KeepsAllUntilItIsFullAndNeverMore) {
  const Cloud cloud = numbered(5000);
  for (const std::size_t most : {1U, 2U, 3U, 1000U, 5000U, 6000U}) {
    CloudSample whole(most);
    whole.add(cloud);
    CloudSample pieces(most);
    for (std::size_t k = 0; k < cloud.size(); k += 50) pieces.add(std::span(cloud).subspan(k, 50));
    EXPECT_EQ(whole.points(), pieces.points());
    EXPECT_LE(whole.points().size(), most);
    if (most >= cloud.size()) {
      EXPECT_EQ(whole.points(), cloud);
    }
  }
}

// Every hundredth of the stream and every beam of scans of 1024 beams has its share: within five standard deviations
// of a binomial distribution.
TEST(CloudSample, SpreadsEvenlyAndSeesNoPeriod) {
  constexpr std::uint32_t kPoints = 1U << 20U;
  CloudSample sample(40000);
  sample.add(numbered(kPoints));
  const auto size = static_cast<double>(sample.points().size());
  EXPECT_GT(size, 15000);
  for (const std::uint32_t cells : {100U, 1024U}) {
    std::vector<int> counts(cells);
    for (const CloudPoint& p : sample.points()) {
      ++counts[cells == 100 ? std::uint64_t{p.scan} * cells / kPoints : p.scan % cells];
    }
    const double mean = size / cells;
    for (const int count : counts) EXPECT_NEAR(count, mean, 5.0 * std::sqrt(mean));
  }
  EXPECT_TRUE(std::is_sorted(sample.points().begin(), sample.points().end(),
                             [](const CloudPoint& a, const CloudPoint& b) { return a.scan < b.scan; }));
}

}  // namespace
}  // namespace gdtslam
