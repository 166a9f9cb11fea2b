// A map of walls, floors and clutter that was tilted on purpose is level again after the turn that is found.
#include "engine/mapping/strokes/levelling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

/// Surfels of a house with a ramp of 3 degrees and things that stand about, with normals that are off by 0.3 degrees.
std::vector<Surfel> house_surfels(Random& random) {
  std::vector<Surfel> surfels;
  const auto add = [&](const Point3& normal, double height_m) {
    Surfel surfel;
    surfel.mean = {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), height_m + random.normal(0.0, 0.005)};
    surfel.normal = normal + 0.005 * Point3(random.normal(), random.normal(), random.normal());
    surfel.normal.normalize();
    surfels.push_back(surfel);
  };
  for (int k = 0; k < 4000; ++k) {
    const double yaw_rad = 0.5 * kPi * static_cast<double>(random.below(4)) + 0.3;
    add({std::cos(yaw_rad), std::sin(yaw_rad), 0.0}, random.uniform(0.0, 2.5));
    add(Point3::UnitZ(), 0.0);
    add(-Point3::UnitZ(), 2.5);
  }
  for (int k = 0; k < 2000; ++k) add({-std::sin(rad_from_deg(3.0)), 0.0, std::cos(rad_from_deg(3.0))}, 0.2);
  for (int k = 0; k < 1200; ++k) {
    add(Point3(random.normal(), random.normal(), random.normal()).normalized(), random.uniform(-0.1, 1.0));
  }
  return surfels;
}

// The mean tilt of the robot, here off by 0.1 deg, counts as much as some hundred surfels.
TEST(FindLevellingTurn, TurnsATiltedHouseBack) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Point3 tilt(random.uniform(-0.015, 0.015), random.uniform(-0.015, 0.015), 0.0);  // up to 0.9 deg
    std::vector<Surfel> surfels = house_surfels(random);
    for (Surfel& surfel : surfels) surfel.normal = Eigen::AngleAxisd(tilt.norm(), tilt.normalized()) * surfel.normal;
    const std::array<double, 2> robot{-tilt.x() + random.normal(0.0, 0.002), -tilt.y() + random.normal(0.0, 0.002)};
    const std::array<double, 2> turn = find_levelling_turn(surfels, robot);
    EXPECT_NEAR(deg_from_rad(turn[0]), deg_from_rad(-tilt.x()), 0.02) << trial;
    EXPECT_NEAR(deg_from_rad(turn[1]), deg_from_rad(-tilt.y()), 0.02) << trial;
  }
}

TEST(FindLevellingTurn, WithoutSurfacesTheRobotIsLevelOnAverage) {
  const std::array<double, 2> robot{0.01, -0.02};
  const std::array<double, 2> turn = find_levelling_turn({}, robot);
  EXPECT_NEAR(turn[0], robot[0], 1.0e-12);
  EXPECT_NEAR(turn[1], robot[1], 1.0e-12);
}

TEST(FindFloorHeight, FindsTheFloorAmongThingsThatStandOnIt) {
  Random random(2);
  std::vector<Surfel> surfels = house_surfels(random);
  for (Surfel& surfel : surfels) surfel.mean.z() += 0.37;
  EXPECT_NEAR(find_floor_height(surfels, 0.32), 0.37, 0.002);
  EXPECT_NEAR(find_floor_height(surfels, 0.42), 0.37, 0.002);
  EXPECT_EQ(find_floor_height(surfels, 1.8), 1.8);  // nothing faces upwards there
  EXPECT_EQ(find_floor_height({}, 0.1), 0.1);
}

}  // namespace
}  // namespace gdtslam
