// find_by_walls: rooms whose places are known, one that turns into itself, clouds without walls.
#include "engine/runs/registration/wall_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gdtslam/core/angle.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::moved;
using test::Rectangle;
using test::strew;

std::vector<WallPlace> places_by_walls(const Cloud& a, const Cloud& b, std::size_t most) {
  return find_by_walls(a, b, most, *make_cpu_backend({}));
}

Cloud bare_room(std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (const Rectangle& side : test::room({6.0, 4.0, 2.5})) strew(cloud, side, 6'000, 0.005, random);
  return cloud;
}

// With an inner wall of two metres.
Cloud divided_room(std::uint64_t seed) {
  Random random(seed + 100);
  Cloud cloud = bare_room(seed);
  strew(cloud, {{0.0, 1.2, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 2.5}}, 3'000, 0.005, random);
  return cloud;
}

// Where b's frame puts the room's middle.
bool is_near(const Pose2& found, const Pose2& truth) {
  const Point2 middle = inverse(truth) * Point2(3.0, 2.0);
  return (found * middle - truth * middle).norm() < 0.1 &&
         std::fabs(wrap_angle(found.theta_rad - truth.theta_rad)) < 0.03;
}

TEST(FindByWalls, FindsARoomAtAnyHeadingAndHeight) {
  const Cloud a = divided_room(1);
  for (const Pose2& T_a_b : {Pose2{12.0, -7.0, 2.4}, Pose2{-30.0, 4.0, -1.1}, Pose2{0.3, 0.2, 3.1}}) {
    Pose3 T_b_a = inverse(embed(T_a_b));
    T_b_a.translation_m.z() += 1.5;
    const auto places = places_by_walls(a, moved(divided_room(2), T_b_a), 2);
    ASSERT_EQ(places.size(), 2U);
    EXPECT_TRUE(is_near(places[0].T_a_b, T_a_b)) << places[0].T_a_b.x_m << " " << places[0].T_a_b.y_m;
    EXPECT_TRUE(places[0].is_proven);
    EXPECT_LT(places[0].mean_m, 0.04);
    EXPECT_GT(places[1].mean_m, places[0].mean_m);
  }
}

TEST(FindByWalls, ABareRoomFitsTurnedByHalfATurnToo) {
  const auto places = places_by_walls(bare_room(3), bare_room(4), 2);
  ASSERT_EQ(places.size(), 2U);
  const Pose2 turned{6.0, 4.0, std::numbers::pi};
  EXPECT_TRUE(is_near(places[0].T_a_b, {}) || is_near(places[1].T_a_b, {}));
  EXPECT_TRUE(is_near(places[0].T_a_b, turned) || is_near(places[1].T_a_b, turned));
  EXPECT_NEAR(places[0].mean_m, places[1].mean_m, 0.015);
}

TEST(FindByWalls, WithoutWallsThereIsNoPlace) {
  Random random(5);
  Cloud floor;
  strew(floor, {{0.0, 0.0, 0.0}, {6.0, 0.0, 0.0}, {0.0, 4.0, 0.0}}, 6'000, 0.005, random);
  EXPECT_TRUE(places_by_walls(floor, floor, 2).empty());
  EXPECT_TRUE(places_by_walls(bare_room(6), floor, 2).empty());
  EXPECT_TRUE(places_by_walls(floor, bare_room(6), 2).empty());
}

}  // namespace
}  // namespace gdtslam
