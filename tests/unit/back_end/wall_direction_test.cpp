// The direction of walls, in rooms turned by known angles.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "engine/mapping/surface/wall_direction.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

constexpr double kTurnOfRoom = 0.3;  // of furnished_room()

// Of the room as it would be seen had the map turned by `turn_rad`, ranges with that much noise.
std::optional<WallDirection> found_in(const std::vector<test::Segment>& walls, double turn_rad, double noise_m) {
  WallDirectionFinder finder;
  Random random(5);
  const std::vector<Pose2> drive = test::drive_through_room();
  for (std::size_t k = 0; k < drive.size(); k += 5) {
    LaserScan scan = test::scan_of(walls, drive[k], 0.0, 360);
    for (float& range : scan.ranges_m) range += static_cast<float>(random.uniform(-noise_m, noise_m));
    finder.add(to_points(scan, {}), Pose2{0, 0, turn_rad} * drive[k]);
  }
  return finder.direction();
}

TEST(WallDirection, IsThatOfTheRoomWithinATenthOfADegree) {
  for (const double degrees : {0.0, 10.0, 27.0, 44.0, 72.8, -33.3, 170.0}) {
    for (const double noise_m : {0.0, 0.02}) {
      const std::optional<WallDirection> found = found_in(test::furnished_room(), rad_from_deg(degrees), noise_m);
      ASSERT_TRUE(found);
      const double off_rad = std::remainder(found->angle_rad - kTurnOfRoom - rad_from_deg(degrees), kPi / 2);
      EXPECT_LT(std::fabs(deg_from_rad(off_rad)), 0.1) << degrees << " degrees, noise " << noise_m;
      EXPECT_LE(std::fabs(found->angle_rad), kPi / 4 + 1e-9);
      EXPECT_GT(found->share, noise_m > 0.0 ? 0.3 : 0.8);
    }
  }
}

// A wall that stands askew is outvoted, however near it lies to the others' direction.
TEST(WallDirection, IsNotPulledByAWallThatStandsAskew) {
  std::vector<test::Segment> walls = test::furnished_room();
  walls.push_back({{2.2, -1.5}, {2.2 + 1.2 * std::cos(kTurnOfRoom + 0.08), -1.5 + 1.2 * std::sin(kTurnOfRoom + 0.08)}});
  const std::optional<WallDirection> found = found_in(walls, 0.0, 0.005);
  ASSERT_TRUE(found);
  EXPECT_NEAR(deg_from_rad(found->angle_rad), deg_from_rad(kTurnOfRoom), 0.1);
}

TEST(WallDirection, ARoundRoomHasNone) {
  std::vector<test::Segment> walls;
  for (int k = 0; k < 90; ++k) {
    const auto corner = [](int at) {
      return Point2(6.0 * std::cos(at * kTwoPi / 90), 6.0 * std::sin(at * kTwoPi / 90));
    };
    walls.push_back({corner(k), corner(k + 1)});
  }
  WallDirectionFinder finder;
  for (int k = 0; k < 8; ++k) {
    const Pose2 T{0.3 * k, 0.1 * k, 0.8 * k};
    finder.add(to_points(test::scan_of(walls, T, 0.0, 360), {}), T);
  }
  EXPECT_FALSE(finder.direction());
  EXPECT_FALSE(WallDirectionFinder().direction());
}

}  // namespace
}  // namespace gdtslam
