// The geometry of a nodding laser against equation (12) as the paper prints it, and the elevation table.
#include "gdtslam/core/nodding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;
using testing::HasSubstr;

constexpr double kTolerance_m = 1e-12;

// Equation (12): x right, y forward, z up; the beam at alpha = bearing + 90 deg.
std::array<double, 3> equation_12(double range_m, double alpha_rad, double theta_rad) {
  const double c = std::cos(theta_rad);
  const double s = std::sin(theta_rad);
  const std::array<std::array<double, 3>, 3> matrix{{{1, 0, 0}, {0, c, 0}, {0, s, 0}}};
  const std::array<double, 3> beam{range_m * std::cos(alpha_rad), range_m * std::sin(alpha_rad), 1.0};
  std::array<double, 3> point{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) point[row] += matrix[row][column] * beam[column];
  }
  return point;
}

Point3 beam_point(double range_m, double bearing_rad) {
  return {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0.0};
}

TEST(Nodding, WithoutLeverIsEquation12) {
  for (double theta_deg = -40.0; theta_deg <= 120.0; theta_deg += 7.3) {
    for (double bearing_deg = -120.0; bearing_deg <= 120.0; bearing_deg += 11.7) {
      const double bearing_rad = rad_from_deg(bearing_deg);
      const Point3 point = T_level_laser(NoddingMount{}, rad_from_deg(theta_deg)) * beam_point(7.5, bearing_rad);
      const std::array<double, 3> paper = equation_12(7.5, bearing_rad + kPi / 2.0, rad_from_deg(theta_deg));
      EXPECT_NEAR(point.x(), paper[1], kTolerance_m);
      EXPECT_NEAR(point.y(), -paper[0], kTolerance_m);
      EXPECT_NEAR(point.z(), paper[2], kTolerance_m);
    }
  }
}

TEST(Nodding, PositiveElevationLiftsTheForwardBeam) {
  const Point3 point = T_level_laser(NoddingMount{}, rad_from_deg(30.0)) * Point3(2.0, 0.0, 0.0);
  EXPECT_NEAR(point.x(), std::sqrt(3.0), kTolerance_m);
  EXPECT_NEAR(point.z(), 1.0, kTolerance_m);
}

TEST(Nodding, SidewaysBeamsNeverMoveWithoutLever) {
  for (double theta_deg = -170.0; theta_deg <= 170.0; theta_deg += 9.1) {
    for (const double side : {-1.0, 1.0}) {
      const Point3 point = T_level_laser(NoddingMount{}, rad_from_deg(theta_deg)) * Point3(0.0, 4.0 * side, 0.0);
      EXPECT_NEAR((point - Point3(0.0, 4.0 * side, 0.0)).norm(), 0.0, kTolerance_m);
    }
  }
}

TEST(Nodding, LeverMovesSidewaysBeamsOnACircleAboutTheAxis) {
  NoddingMount mount;
  mount.lever_forward_m = 0.04;
  mount.lever_up_m = 0.03;
  for (double theta_deg = -170.0; theta_deg <= 170.0; theta_deg += 9.1) {
    const Point3 point = T_level_laser(mount, rad_from_deg(theta_deg)) * Point3(0.0, 4.0, 0.0);
    const Point3 from_axis = point - Point3(-0.04, 4.0, -0.03);
    EXPECT_NEAR(from_axis.y(), 0.0, kTolerance_m);
    EXPECT_NEAR(from_axis.norm(), 0.05, kTolerance_m);
  }
  EXPECT_THAT(T_level_laser(mount, 0.0), PoseNear(Pose3{}, kTolerance_m, 1e-10));
}

// Equation (A1) as docs/paper.md has it: r = (d - a cos theta + b sin theta) / (sin alpha cos theta) to a wall at d
// from the axis.
TEST(Nodding, LeverAgreesWithTheRangeToAWall) {
  NoddingMount mount;
  mount.lever_forward_m = 0.031;
  mount.lever_up_m = 0.057;
  constexpr double kWall_m = 2.0;
  for (double theta_deg = -30.0; theta_deg <= 80.0; theta_deg += 5.5) {
    for (const double alpha_deg : {20.0, 70.0, 90.0, 140.0}) {
      const double theta_rad = rad_from_deg(theta_deg);
      const double alpha_rad = rad_from_deg(alpha_deg);
      const double range_m =
          (kWall_m - mount.lever_forward_m * std::cos(theta_rad) + mount.lever_up_m * std::sin(theta_rad)) /
          (std::sin(alpha_rad) * std::cos(theta_rad));
      const Point3 hit = T_level_laser(mount, theta_rad) * beam_point(range_m, alpha_rad - kPi / 2.0);
      EXPECT_NEAR(hit.x() + mount.lever_forward_m, kWall_m, 1e-11);
    }
  }
}

// Yaw turns the beams within the scan plane; roll tips the plane about its forward direction.
TEST(Nodding, MountingAngles) {
  NoddingMount yawed;
  yawed.sensor_yaw_rad = 0.1;
  const Point3 turned = T_level_laser(yawed, 0.7) * beam_point(3.0, 0.25);
  const Point3 straight = T_level_laser(NoddingMount{}, 0.7) * beam_point(3.0, 0.35);
  EXPECT_NEAR((turned - straight).norm(), 0.0, kTolerance_m);

  NoddingMount rolled;
  rolled.sensor_roll_rad = 0.2;
  const Point3 left = T_level_laser(rolled, 0.0) * Point3(0.0, 5.0, 0.0);
  EXPECT_NEAR(left.y(), 5.0 * std::cos(0.2), kTolerance_m);
  EXPECT_NEAR(left.z(), 5.0 * std::sin(0.2), kTolerance_m);
  EXPECT_NEAR((T_level_laser(rolled, 0.0) * Point3(5.0, 0.0, 0.0) - Point3(5.0, 0.0, 0.0)).norm(), 0.0, kTolerance_m);
}

TEST(Nodding, BaseFrameHasTheMountsPlaceAndHeight) {
  NoddingMount mount;
  mount.height_m = 0.42;
  const Pose2 T_base_level{0.3, -0.1, rad_from_deg(90.0)};
  const Point3 ahead = T_base_laser(mount, T_base_level, rad_from_deg(60.0)) * Point3(2.0, 0.0, 0.0);
  EXPECT_NEAR(ahead.x(), 0.3, kTolerance_m);
  EXPECT_NEAR(ahead.y(), -0.1 + 1.0, kTolerance_m);
  EXPECT_NEAR(ahead.z(), 0.42 + std::sqrt(3.0), kTolerance_m);
}

TEST(Phase, CountsTurnsAndWraps) {
  EXPECT_EQ(phase_of_turns(0.0), 0U);
  EXPECT_EQ(phase_of_turns(0.25), 0x40000000U);
  EXPECT_EQ(phase_of_turns(-0.25), 0xC0000000U);
  EXPECT_EQ(phase_of_turns(7.5), 0x80000000U);
  EXPECT_EQ(phase_of_turns(1.0 - 1e-12), 0U);  // nearer to the next turn's begin than to the last step
  EXPECT_EQ(phase_of_turns(-1e-300), 0U);
  EXPECT_DOUBLE_EQ(turns_of_phase(0x80000001U), 0.5 + 1.0 / 4294967296.0);
}

TEST(ElevationTable, IsLinearBetweenItsEntries) {
  const ElevationTable table({0.0, 1.0, 0.5, -0.25, 0.0});
  EXPECT_EQ(table.bits(), 2U);
  EXPECT_DOUBLE_EQ(table.elevation_rad(phase_of_turns(0.0)), 0.0);
  EXPECT_DOUBLE_EQ(table.elevation_rad(phase_of_turns(0.125)), 0.5);
  EXPECT_DOUBLE_EQ(table.elevation_rad(phase_of_turns(0.25)), 1.0);
  EXPECT_DOUBLE_EQ(table.elevation_rad(phase_of_turns(0.5625)), 0.5 - 0.75 / 4.0);
  EXPECT_NEAR(table.elevation_rad(0xFFFFFFFFU), 0.0, 1e-9);  // towards the last entry
}

TEST(ElevationTable, IdentityGivesTheElevationBack) {
  const ElevationTable table = ElevationTable::identity();
  for (double elevation_rad = -3.14; elevation_rad < 3.14; elevation_rad += 0.01) {
    EXPECT_NEAR(table.elevation_rad(phase_of_elevation(elevation_rad)), elevation_rad, kTwoPi / 4294967296.0);
  }
}

TEST(ElevationTable, RefusesWhatIsNoTable) {
  const auto refusal = [](std::vector<double> values_rad) -> std::string {
    try {
      ElevationTable{std::move(values_rad)};
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal({}), HasSubstr("not 0"));
  EXPECT_THAT(refusal({0.0}), HasSubstr("2^k + 1"));
  EXPECT_THAT(refusal(std::vector<double>(4)), HasSubstr("not 4"));
  EXPECT_THAT(refusal(std::vector<double>((std::size_t{1} << 21) + 1)), HasSubstr("not 2097153"));
  EXPECT_THAT(refusal({0.0, std::numeric_limits<double>::quiet_NaN()}), HasSubstr("not finite"));
  EXPECT_THAT(refusal({0.0, 6.3}), HasSubstr("beyond 2 pi"));
  EXPECT_EQ(refusal({0.0, 6.28}), "accepted");
  EXPECT_EQ(refusal(std::vector<double>((std::size_t{1} << 20) + 1)), "accepted");
}

TEST(BeamTiming, CountsFromTheFirstBeam) {
  const BeamTiming timing{-0.01, 0.001};
  EXPECT_DOUBLE_EQ(timing.of_beam_s(0), -0.01);
  EXPECT_DOUBLE_EQ(timing.of_beam_s(25), 0.015);
}

}  // namespace
}  // namespace gdtslam
