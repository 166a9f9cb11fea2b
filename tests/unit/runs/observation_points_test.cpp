// Scans of an observation in the frame of its last one: expected places are those of the motion that the test made up.
#include "engine/runs/drive/observation_points.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

/// One beam straight ahead of laser 0 and back of laser 1, each in the robot's centre.
ScanRecord single_beam(double stamp_s, std::size_t laser, const std::optional<Pose2>& T_odom_base) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.scan.ranges_m = {2.0F};
  record.scan.T_base_laser = {0.0, 0.0, laser == 0 ? 0.0 : kPi};
  record.T_odom_base = T_odom_base;
  record.laser = laser;
  return record;
}

Pose2 ahead(double x_m) { return {x_m, 0.0, 0.0}; }

MatchResult matched(double stamp_s, const Pose2& T_map_base, bool merged = true) {
  MatchResult match;
  match.stamp_s = stamp_s;
  match.T_map_base = T_map_base;
  match.accepted = true;
  match.merged = merged;
  return match;
}

TEST(ObservationPoints, AreWhereTheOdometrySawThemFrom) {
  ObservationPoints points{ScanConfig{}};
  const Observation observation{single_beam(1.0, 0, ahead(5.0)), single_beam(1.1, 1, ahead(5.07))};
  const std::vector<ObservedScan> places = points.place(observation);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_NEAR(places[0].T_last_scan.x_m, -0.07, 1e-12);
  EXPECT_FALSE(places[0].is_last);
  EXPECT_TRUE(places[1].is_last);
  EXPECT_EQ(places[1].T_last_scan, Pose2{});
  const PointScan scan = points.points(observation, places);
  ASSERT_EQ(scan.points_base_m.size(), 2U);
  EXPECT_EQ(scan.stamp_s, 1.1);
  EXPECT_NEAR(scan.points_base_m[0].x(), 1.93, 1e-6);
  EXPECT_NEAR(scan.points_base_m[1].x(), -2.0, 1e-6);
}

// Half a metre a second by the map, where the odometry is missing, is one pose again and again, or leaps.
TEST(ObservationPoints, AreWhereTheLastMotionSawThemFromWithoutOdometry) {
  for (const std::optional<double> leap_m : {std::optional<double>{}, std::optional(0.0), std::optional(40.0)}) {
    ObservationPoints points{ScanConfig{}};
    const auto odometry = [&](double x_m) { return leap_m ? std::optional(ahead(x_m)) : std::nullopt; };
    std::vector<ObservedScan> place(1);
    points.take({single_beam(1.0, 0, odometry(0.0))}, matched(1.0, ahead(0.0)), place);
    points.take({single_beam(1.2, 0, odometry(0.0))}, matched(1.2, ahead(0.1)), place);
    const Observation observation{single_beam(1.3, 0, odometry(0.0)),
                                  single_beam(1.4, 1, odometry(leap_m.value_or(0.0)))};
    std::vector<ObservedScan> places = points.place(observation);
    EXPECT_NEAR(places[0].T_last_scan.x_m, -0.05, 1e-12);
    points.take(observation, matched(1.4, ahead(0.3)), places);
    EXPECT_NEAR(places[0].T_last_scan.x_m, -0.1, 1e-12) << "a metre a second, as is known then";
  }
}

TEST(ObservationPoints, OfALaserThatTheMapDoesNotKnowAreUnknown) {
  ObservationPoints points{ScanConfig{}};
  const auto unknown = [&](std::size_t first, std::size_t second) {
    const Observation observation{single_beam(1.0, first, ahead(0.0)), single_beam(1.0, second, ahead(0.0))};
    const PointScan scan = points.points(observation, points.place(observation));
    return std::pair(scan.unknown_points, scan.points_base_m.back().x() > 0.0 ? 0U : 1U);
  };
  EXPECT_EQ(unknown(0, 1).first, 0U) << "nothing is known";
  std::vector<ObservedScan> place(1);
  points.take({single_beam(0.9, 0, ahead(0.0))}, matched(0.9, {}), place);
  EXPECT_EQ(unknown(0, 1), std::pair(std::size_t{1}, 1U));
  EXPECT_EQ(unknown(1, 0), std::pair(std::size_t{1}, 1U)) << "they are the last ones";
  points.take({single_beam(0.9, 1, ahead(0.0))}, matched(0.9, {}, false), place);
  EXPECT_EQ(unknown(0, 1).first, 1U) << "matched, but not merged";
  points.take({single_beam(0.9, 1, ahead(0.0))}, matched(0.9, {}), place);
  EXPECT_EQ(unknown(0, 1).first, 0U);
}

TEST(PathOfScans, HasAPoseForEachScan) {
  ClosedPath path{.T_map_base = {ahead(0.0), ahead(1.0), ahead(2.0)},
                  .covariances = {{.xx = 1.0}, {.xx = 2.0}, {.xx = 3.0}},
                  .wheels = {},
                  .keyframes = {0, 2},
                  .loops = {{.from = 0, .to = 2, .T_from_to = {}, .information = {}}},
                  .places = {{0, {}}, {2, {}}},
                  .path = {{.from = 0, .to = 2, .T_from_to = {}, .information = {}}}};
  const std::vector<ObservedScan> scans{{}, {ahead(-0.1), false}, {}, {ahead(-0.2), false}, {}};
  path = path_of_scans(path, scans);
  const std::vector<double> expected_m{0.0, 0.9, 1.0, 1.8, 2.0};
  ASSERT_EQ(path.T_map_base.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(path.T_map_base[i].x_m, expected_m[i], 1e-12) << i;
  EXPECT_EQ(path.covariances[3].xx, 3.0);
  EXPECT_EQ(path.keyframes, (std::vector<std::size_t>{0, 3, 4}));
  EXPECT_EQ(path.loops[0].to, 4U);
  EXPECT_EQ(path.places[1].scan, 4U);
  EXPECT_EQ(path.path[0].to, 4U);
}

}  // namespace
}  // namespace gdtslam
