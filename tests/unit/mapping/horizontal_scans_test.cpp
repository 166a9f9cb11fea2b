// Which scans of a nodding laser count as horizontal, what counts as a stroke, and how a scan is levelled while the
// robot and the mount move: at and beside each limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "engine/mapping/nodding/horizontal_scans.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

const NoddingScanner kScanner{{.height_m = 0.4}, ElevationTable::identity(), 0.0, 0.5};

/// One beam straight ahead, while the elevation goes from one to the other.
NoddingScan nodding_scan(double from_deg, double to_deg, double stamp_s = 1.0) {
  NoddingScan scan;
  scan.record.scan.stamp_s = stamp_s;
  scan.record.scan.ranges_m = {2.0F};
  scan.knots = {{0.0, phase_of_elevation(rad_from_deg(from_deg))}, {0.1, phase_of_elevation(rad_from_deg(to_deg))}};
  return scan;
}

HorizontalScans within_a_degree() {
  NoddingConfig config;
  config.horizontal_rad = rad_from_deg(1.0);
  return {config, kScanner, {}};
}

/// Takes a scan at an elevation; the strokes by then.
auto counter_of_strokes(HorizontalScans& scans) {
  return [&scans](double at_deg) {
    static_cast<void>(scans.take(nodding_scan(at_deg, at_deg)));
    return scans.strokes();
  };
}

TEST(HorizontalScans, AllElevationsLieWithinTheTolerance) {
  HorizontalScans scans = within_a_degree();
  const auto is_level = [&](double from_deg, double to_deg) {
    return scans.take(nodding_scan(from_deg, to_deg)).has_value();
  };
  EXPECT_TRUE(is_level(0.0, 0.0));
  EXPECT_TRUE(is_level(-0.99, 0.99));
  EXPECT_FALSE(is_level(-1.01, 0.0));
  EXPECT_FALSE(is_level(0.0, 1.01));
  EXPECT_FALSE(is_level(1.01, 0.0));
  EXPECT_FALSE(is_level(-2.0, 2.0)) << "level on its way only";
  NoddingScan unknown = nodding_scan(0.0, 0.0);
  unknown.knots.clear();
  EXPECT_FALSE(scans.take(unknown));
}

// A turn counts once it is two degrees wide, twice the tolerance; the first motion is a stroke however small.
TEST(HorizontalScans, AStrokeEndsWhereTheElevationTurns) {
  HorizontalScans scans = within_a_degree();
  const auto strokes_with = counter_of_strokes(scans);
  EXPECT_EQ(strokes_with(0.0), 0U);
  EXPECT_EQ(strokes_with(0.5), 1U);
  EXPECT_EQ(strokes_with(10.0), 1U);
  EXPECT_EQ(strokes_with(8.1), 1U) << "it shakes";
  EXPECT_EQ(strokes_with(9.0), 1U);
  EXPECT_EQ(strokes_with(7.9), 2U) << "below the top of 10 degrees, not of 9";
  EXPECT_EQ(strokes_with(-5.0), 2U);
  EXPECT_EQ(strokes_with(-3.1), 2U);
  EXPECT_EQ(strokes_with(-2.9), 3U);
  EXPECT_EQ(strokes_with(-5.0), 4U);
}

TEST(HorizontalScans, WhereTheFirstScanIsRaisedNoStrokeHasBeen) {
  HorizontalScans scans = within_a_degree();
  const auto strokes_with = counter_of_strokes(scans);
  EXPECT_EQ(strokes_with(80.0), 0U);
  EXPECT_EQ(strokes_with(40.0), 1U) << "down";
  EXPECT_EQ(strokes_with(0.0), 1U);
  EXPECT_EQ(strokes_with(40.0), 2U) << "up";
}

TEST(HorizontalScans, WithoutOneItSaysWhichElevationsItSaw) {
  HorizontalScans scans = within_a_degree();
  EXPECT_THAT([&] { scans.throw_none(); }, testing::ThrowsMessage<InputError>(testing::HasSubstr("no ENCODER")));
  static_cast<void>(scans.take(nodding_scan(12.04, 14.0)));
  static_cast<void>(scans.take(nodding_scan(20.0, -3.96)));
  EXPECT_THAT([&] { scans.throw_none(); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("from -4.0 to 20.0 deg"), testing::HasSubstr("is 1.0 deg"))));
}

/// A mirror that turns once in a second: beams a quarter turn apart are 0.25 s apart, the stamp is that of the last.
NoddingScanner turning_once_a_second() { return {{.height_m = 0.4}, ElevationTable::identity(), 1.0, 1.0}; }

NoddingScan three_beams(double stamp_s) {
  NoddingScan scan;
  scan.record.scan.stamp_s = stamp_s;
  scan.record.scan.first_bearing_rad = -0.5 * kPi;
  scan.record.scan.bearing_step_rad = 0.5 * kPi;
  scan.record.scan.ranges_m = {3.0F, 4.0F, 5.0F};
  scan.knots = {{-0.5, phase_of_elevation(0.0)}, {0.0, phase_of_elevation(0.0)}};
  return scan;
}

// A metre in half a second: 0.5 s before the stamp the robot was a metre behind.
TEST(LevelPoints, AreSeenFromWhereTheRobotWasAtEachBeam) {
  NoddingScan scan = three_beams(2.0);
  scan.record.T_odom_base = Pose2{1.0, 0.0, 0.0};
  const auto points_since = [&](const std::optional<Odometry>& before) {
    return level_points(scan, turning_once_a_second(), {}, before).points_base_m;
  };
  const std::vector<Point2> moved = points_since(Odometry{1.5, {}});
  ASSERT_EQ(moved.size(), 3U);
  EXPECT_NEAR(moved[0].x(), -1.0, 1e-6);
  EXPECT_NEAR(moved[0].y(), -3.0, 1e-6);
  EXPECT_NEAR(moved[1].x(), 4.0 - 0.5, 1e-6);
  EXPECT_NEAR(moved[2].x(), 0.0, 1e-6);
  EXPECT_NEAR(moved[2].y(), 5.0, 1e-6);
  // Of a step of more than half a second, of none or without odometry nothing is said.
  EXPECT_NEAR(points_since(Odometry{1.49, {}})[0].x(), 0.0, 1e-6);
  EXPECT_NEAR(points_since(Odometry{2.0, {}})[0].x(), 0.0, 1e-6);
  EXPECT_NEAR(points_since(std::nullopt)[0].x(), 0.0, 1e-6);
  scan.record.T_odom_base.reset();
  EXPECT_NEAR(points_since(Odometry{1.5, {}})[0].x(), 0.0, 1e-6);
}

// A quarter turn in half a second.
TEST(LevelPoints, TurnWithTheRobot) {
  NoddingScan scan = three_beams(2.0);
  scan.record.T_odom_base = Pose2{0.0, 0.0, 0.5 * kPi};
  const std::vector<Point2> points = level_points(scan, turning_once_a_second(), {}, Odometry{1.5, {}}).points_base_m;
  ASSERT_EQ(points.size(), 3U);
  EXPECT_NEAR(points[0].x(), -3.0, 1e-6) << "what was to its right is behind it";
  EXPECT_NEAR(points[0].y(), 0.0, 1e-6);
  EXPECT_NEAR(points[1].x(), 4.0 * std::cos(0.25 * kPi), 1e-6);
  EXPECT_NEAR(points[1].y(), -4.0 * std::sin(0.25 * kPi), 1e-6);
}

// The elevation at the beam's own time: half way between two knots, and what the outer ones say beyond them.
TEST(LevelPoints, AreRaisedAsTheMountWasAtEachBeam) {
  const auto ahead_at = [](const std::vector<std::pair<double, double>>& knots) {
    NoddingScan scan = three_beams(2.0);
    scan.knots.clear();
    for (const auto& [offset_s, elevation_rad] : knots) {
      scan.knots.push_back({offset_s, phase_of_elevation(elevation_rad)});
    }
    return level_points(scan, turning_once_a_second(), {}, std::nullopt).points_base_m.at(1).x();
  };
  // The beam ahead is measured a quarter of a second before the stamp.
  EXPECT_NEAR(ahead_at({{-0.5, 0.2}, {0.0, 0.6}}), 4.0 * std::cos(0.4), 1e-5);
  EXPECT_NEAR(ahead_at({{-0.5, 0.6}, {0.0, -0.2}}), 4.0 * std::cos(0.2), 1e-5);
  EXPECT_NEAR(ahead_at({{-0.5, 0.0}, {-0.3, 0.0}, {-0.2, 1.0}, {0.0, 1.0}}), 4.0 * std::cos(0.5), 1e-5);
  EXPECT_NEAR(ahead_at({{-0.5, 0.0}, {-0.25, 0.3}, {0.0, 1.0}}), 4.0 * std::cos(0.3), 1e-5);
  EXPECT_NEAR(ahead_at({{-0.2, 0.3}, {0.0, 1.0}}), 4.0 * std::cos(0.3), 1e-5) << "before the first knot";
  EXPECT_NEAR(ahead_at({{-0.5, 1.0}, {-0.3, 0.3}}), 4.0 * std::cos(0.3), 1e-5) << "behind the last one";
}

TEST(LevelPoints, CountFromTheLeastRangeUpToTheMost) {
  NoddingScan scan = three_beams(2.0);
  const auto count = [&](double least_m, double most_m) {
    return level_points(scan, turning_once_a_second(), {.min_range_m = least_m, .max_range_m = most_m}, std::nullopt)
        .points_base_m.size();
  };
  EXPECT_EQ(count(3.0, 5.5), 3U);
  EXPECT_EQ(count(3.01, 5.5), 2U);
  EXPECT_EQ(count(3.0, 5.0), 2U);
}

}  // namespace
}  // namespace gdtslam
