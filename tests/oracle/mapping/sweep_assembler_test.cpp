// The assembler's points against the motion written out in double: T_map_base(t) * T_base_laser(elevation(t)) * beam,
// every beam at its own time, with the C library's sines and Eigen's transforms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"
#include "support/sweep_scans.hpp"

namespace gdtslam::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double kAllowed_m = 2.0e-4;  // at 20 m

/// A value between two knots, the last ones held before and after.
template <class Knot, class Value>
double at_time(const std::vector<Knot>& knots, double time_s, bool is_angle, Value value) {
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double length = knots[i + 1].offset_s - knots[i].offset_s;
    if (time_s <= knots[i + 1].offset_s && length > 0.0) {
      const double share = (time_s - knots[i].offset_s) / length;
      const double rise = value(knots[i + 1]) - value(knots[i]);
      return value(knots[i]) + share * (is_angle ? std::remainder(rise, kTwoPi) : rise);
    }
  }
  return value(knots.back());
}

Isometry3d planar(double x_m, double y_m, double theta_rad) {
  return Translation3d(x_m, y_m, 0.0) * AngleAxisd(theta_rad, Vector3d::UnitZ());
}
Isometry3d planar(const Pose2& pose) { return planar(pose.x_m, pose.y_m, pose.theta_rad); }

/// Elevation of the scan plane for an angle of the crank after phase 0.
using Elevation = std::function<double(double)>;

Vector3d true_point(const SweepScan& scan, const NoddingScanner& scanner, const Elevation& elevation,
                    std::size_t beam) {
  const LaserScan& laser = scan.scan.record.scan;
  const double duration_s = scanner.mirror_rate_hz > 0.0 ? laser.bearing_step_rad / kTwoPi / scanner.mirror_rate_hz : 0;
  const double beams = static_cast<double>(laser.ranges_m.size());
  const double time_s = duration_s * (static_cast<double>(beam) - scanner.stamp_share * (beams - 1.0));
  const double crank = at_time(scan.scan.knots, time_s, true, [](const PhaseKnot& knot) {
    return kTwoPi * std::ldexp(static_cast<double>(knot.phase), -32);
  });
  const Isometry3d T_fix_base =
      planar(at_time(scan.poses, time_s, false, [](const PoseKnot& knot) { return knot.T_fix_base.x_m; }),
             at_time(scan.poses, time_s, false, [](const PoseKnot& knot) { return knot.T_fix_base.y_m; }),
             at_time(scan.poses, time_s, true, [](const PoseKnot& knot) { return knot.T_fix_base.theta_rad; }));
  const NoddingMount& mount = scanner.mount;
  const Vector3d lever(mount.lever_forward_m, 0.0, mount.lever_up_m);
  const double bearing = laser.first_bearing_rad + static_cast<double>(beam) * laser.bearing_step_rad;
  const Vector3d in_laser =
      static_cast<double>(laser.ranges_m[beam]) * Vector3d(std::cos(bearing), std::sin(bearing), 0.0);
  // The nod lifts what lies ahead: a turn about the left axis, backwards.
  const Isometry3d T_level_laser = Translation3d(-lever) * AngleAxisd(-elevation(crank), Vector3d::UnitY()) *
                                   Translation3d(lever) * AngleAxisd(mount.sensor_yaw_rad, Vector3d::UnitZ()) *
                                   AngleAxisd(mount.sensor_roll_rad, Vector3d::UnitX());
  return planar(scan.T_map_fix) * T_fix_base * Translation3d(0.0, 0.0, mount.height_m) * planar(laser.T_base_laser) *
         T_level_laser * in_laser;
}

bool is_return(float range_m) { return range_m >= 0.1F && range_m < 20.0F; }

void expect_true_points(const std::vector<SweepScan>& scans, const NoddingScanner& scanner,
                        const Elevation& elevation) {
  const auto cpu = make_cpu_backend({});
  const Cloud cloud = assemble(scanner, {}, scans, *cpu);
  std::size_t next = 0;
  double worst_m = 0.0;
  for (const SweepScan& scan : scans) {
    const auto& ranges = scan.scan.record.scan.ranges_m;
    for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
      if (!is_return(ranges[beam])) continue;
      ASSERT_LT(next, cloud.size());
      const CloudPoint& point = cloud[next++];
      const Vector3d found = Eigen::Vector3f(point.x_m, point.y_m, point.z_m).cast<double>();
      worst_m = std::max(worst_m, (found - true_point(scan, scanner, elevation, beam)).norm());
      ASSERT_EQ(point.scan, scan.index);
    }
  }
  EXPECT_EQ(next, cloud.size());
  EXPECT_LT(worst_m, kAllowed_m);
  testing::Test::RecordProperty("worst_um", static_cast<int>(worst_m * 1.0e6));
}

TEST(SweepAssembler, PlacesBeamsWhereTheMotionWrittenOutInDoubleDoes) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const NoddingScanner scanner = draw_scanner(random);
    const auto table = [&](double crank) {  // linear between the entries, which is what a table says
      const auto& values = scanner.table.values_rad();
      const double turns = crank / kTwoPi - std::floor(crank / kTwoPi);
      const double place = turns * static_cast<double>(values.size() - 1);
      const auto index = static_cast<std::size_t>(place);
      return values[index] + (place - std::floor(place)) * (values[index + 1] - values[index]);
    };
    expect_true_points(draw_sweep_scans(random, scanner, 20), scanner, table);
  }
}

// The paper's linkages, their elevation from the closed form instead of the table.
TEST(SweepAssembler, PlacesBeamsOfEveryLinkage) {
  for (const char* preset : {"paper-a", "paper-b", "paper-c"}) {
    SCOPED_TRACE(preset);
    Random random(17);
    const calib::SweepModel model = calib::sweep_model_of_preset(preset);
    NoddingScanner scanner = draw_scanner(random);
    scanner.table = calib::elevation_table(model);
    const auto elevation = [&](double crank) {
      return calib::elevation_rad(model, model.encoder.zero_rad + model.encoder.direction * crank).value();
    };
    expect_true_points(draw_sweep_scans(random, scanner, 100), scanner, elevation);
  }
}

// A tilting laser: the table is the identity, so phases are elevations.
TEST(SweepAssembler, PlacesBeamsOfATiltingLaser) {
  Random random(23);
  NoddingScanner scanner = draw_scanner(random);
  scanner.table = ElevationTable::identity();
  expect_true_points(draw_sweep_scans(random, scanner, 100), scanner, [](double turn) { return turn - kPi; });
}

// All beams at once, at the stamp.
TEST(SweepAssembler, PlacesBeamsOfAScanWithoutDuration) {
  Random random(29);
  NoddingScanner scanner = draw_scanner(random);
  scanner.table = ElevationTable::identity();
  scanner.mirror_rate_hz = 0.0;
  expect_true_points(draw_sweep_scans(random, scanner, 50), scanner, [](double turn) { return turn - kPi; });
}

}  // namespace
}  // namespace gdtslam::test
