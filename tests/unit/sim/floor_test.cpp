// Ramps, plates and sills: the height that a wheel meets, and the triangles that a ray meets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/sim/ray_caster.hpp"
#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {
namespace {

using testing::HasSubstr;

// A ramp from (2, 1) at 0.1 m to (6, 4) at 0.6 m: 5 m long in the plan.
FloorPart slanted_ramp() { return make_ramp({2.0, 1.0, 0.1}, {6.0, 4.0, 0.6}, 2.0); }

TEST(Floor, ARampRisesEvenlyBetweenItsEnds) {
  const std::vector<FloorPart> parts{slanted_ramp()};
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    for (const double left_m : {-0.99, 0.0, 0.99}) {
      const Point2 place(2.0 + 4.0 * share - 0.6 * left_m, 1.0 + 3.0 * share + 0.8 * left_m);
      EXPECT_NEAR(floor_height_m(parts, 0.05, place), 0.1 + 0.5 * share, 1e-12);
    }
  }
  EXPECT_EQ(floor_height_m(parts, 0.05, {2.0 - 0.6 * 1.01 + 2.0, 1.0 + 0.8 * 1.01 + 1.5}), 0.05);  // beside it
  EXPECT_EQ(floor_height_m(parts, 0.05, {6.1, 4.1}), 0.05);                                        // beyond its end
}

TEST(Floor, ASillRisesByACosineAcrossADoor) {
  const std::vector<FloorPart> parts{make_sill({1.0, 3.0}, {1.0, 4.0}, 0.1, 0.016, 0.3)};
  EXPECT_NEAR(floor_height_m(parts, 0.0, {1.0, 3.5}), 0.316, 1e-12);
  EXPECT_NEAR(floor_height_m(parts, 0.0, {1.025, 3.9}), 0.308, 1e-12);
  EXPECT_NEAR(floor_height_m(parts, 0.0, {0.975, 3.1}), 0.308, 1e-12);
  EXPECT_EQ(floor_height_m(parts, 0.0, {1.051, 3.5}), 0.0);
  EXPECT_EQ(floor_height_m(parts, 0.0, {1.0, 4.01}), 0.0);
}

TEST(Floor, ARayFromAboveMeetsTheHeightOfAWheel) {
  Scene scene;
  scene.floor_m = 0.05;
  scene.floor_parts = {slanted_ramp(), make_plate({8.0, 5.5}, {5.0, 4.0}, std::atan2(3.0, 4.0), 0.6),
                       make_sill({3.0, 1.5}, {2.5, 2.5}, 0.2, 0.1, 0.3)};
  for (const double at_m : {-5.0, 20.0}) scene.boxes.push_back({{at_m, at_m}, {1.0, 1.0}, 0.0, 0.0, 1.0});
  const RayCaster caster(triangulate(scene));
  Random random(3);
  std::size_t raised = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Point2 place(random.uniform(0.0, 12.0), random.uniform(0.0, 9.0));
    const auto hit = caster.cast({{place.x(), place.y(), 2.0}, {0.0, 0.0, -1.0}}, 5.0);
    ASSERT_TRUE(hit);
    const double height_m = floor_height_m(scene.floor_parts, 0.05, place);
    EXPECT_NEAR(2.0 - hit->range_m, height_m, 1e-9) << place.transpose();
    raised += height_m > 0.05 ? 1U : 0U;
  }
  EXPECT_GT(raised, 5'000U);
  // Where ramp and plate touch there is no gap.
  for (int i = 0; i < 1'000; ++i) {
    const double left_m = -0.9 + 0.0018 * i;
    EXPECT_NEAR(floor_height_m(scene.floor_parts, 0.05, {6.0 - 0.6 * left_m, 4.0 + 0.8 * left_m}), 0.6, 1e-6);
  }
}

TEST(Floor, ItsSidesAreSolid) {
  Scene scene;
  scene.floor_m = 0.0;
  scene.floor_parts = {make_ramp({0.0, 0.0, 0.0}, {4.0, 0.0, 0.4}, 2.0)};
  const RayCaster caster(triangulate(scene));
  const auto range_m = [&](const Vec3& from_m, const Vec3& direction) {
    const auto hit = caster.cast({from_m, direction}, 10.0);
    return hit ? hit->range_m : -1.0;
  };
  EXPECT_NEAR(range_m({3.0, 5.0, 0.2}, {0.0, -1.0, 0.0}), 4.0, 1e-12);
  EXPECT_NEAR(range_m({3.0, -5.0, 0.2}, {0.0, 1.0, 0.0}), 4.0, 1e-12);
  EXPECT_NEAR(range_m({9.0, 0.0, 0.2}, {-1.0, 0.0, 0.0}), 5.0, 1e-12);
  EXPECT_NEAR(range_m({-3.0, 0.0, 0.2}, {1.0, 0.0, 0.0}), 5.0, 1e-12);
  EXPECT_EQ(range_m({1.0, 5.0, 0.2}, {0.0, -1.0, 0.0}), -1.0);  // over the ramp
}

TEST(Floor, RefusesPartsThatLieOnNoFloor) {
  Scene scene;
  scene.floor_parts = {slanted_ramp()};
  const auto refusal = [&] {
    try {
      triangulate(scene);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(), HasSubstr("lie on a floor, but the scene has none: add `floor: 0`"));
  scene.floor_m = 0.2;
  EXPECT_THAT(refusal(), HasSubstr("is at 0.100000 m, under the floor at 0.200000 m: raise it, or lower the floor"));
  scene.floor_m = 0.0;
  scene.floor_parts = {make_ramp({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 1.0)};
  EXPECT_THAT(refusal(), HasSubstr("ramp, plate or sill 1 of the scene: its length along the profile"));
  scene.floor_parts = {make_ramp({0.0, 0.0, 0.0}, {1.0, 0.0, 1.0}, std::nan(""))};
  EXPECT_THAT(refusal(), HasSubstr("each side must be 1 mm to 2000 m"));
}

}  // namespace
}  // namespace gdtslam::sim
