// What a range says of the mount, against the motion of core/nodding and against differences of itself.
#include "calib/calibration/calibration_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kLever[] = {0.03, -0.02};

SweepModel scanner() {
  SweepModel model = sweep_model_of_preset("paper-b");
  model.mount.lever_forward_m = kLever[0];
  model.mount.lever_up_m = kLever[1];
  model.mount.sensor_roll_rad = 0.05;
  model.mount.sensor_yaw_rad = -0.04;
  return model;
}

std::vector<CalibrationSurface> surfaces() {
  return {{.name = "wall", .distance_m = 2.0},
          {.name = "slanted", .distance_m = 2.3, .heading_rad = 0.4},
          {.name = "floor", .kind = SurfaceKind::kFloor, .distance_m = 0.4},
          {.name = "ceiling", .kind = SurfaceKind::kCeiling, .distance_m = 2.1}};
}

std::vector<RangeObservation> observations() {
  std::vector<RangeObservation> list;
  for (const double ticks : {300.0, 4000.0, 9000.0, 14000.0, 18500.0}) {
    for (const double bearing : {0.0, 0.5, -0.3}) {
      list.push_back({.ticks = ticks, .bearing_rad = bearing, .range_m = 2.0 + ticks / 5000.0});
    }
  }
  return list;
}

// The normal as a plane's first-order tilt has it: walls lean away, floor and ceiling rise ahead.
Point3 normal(const CalibrationSurface& surface, double tilt) {
  if (surface.kind == SurfaceKind::kFloor) return {std::sin(tilt), 0.0, -std::cos(tilt)};
  if (surface.kind == SurfaceKind::kCeiling) return {-std::sin(tilt), 0.0, std::cos(tilt)};
  return {std::cos(tilt) * std::cos(surface.heading_rad), std::cos(tilt) * std::sin(surface.heading_rad),
          -std::sin(tilt)};
}

// The same miss by rigid motions: the measured point in the level frame, seen from the nodding axis.
double miss_by_motion(const SweepModel& model, const CalibrationSurface& surface, const RangeObservation& seen,
                      double tilt = 0.0) {
  const double elevation = *elevation_rad(model, crank_rad(model.encoder, seen.ticks));
  const Point3 in_laser(seen.range_m * std::cos(seen.bearing_rad), seen.range_m * std::sin(seen.bearing_rad), 0.0);
  const Point3 lever(model.mount.lever_forward_m, 0.0, model.mount.lever_up_m);
  const Point3 from_axis = T_level_laser(model.mount, elevation) * in_laser + lever;
  return normal(surface, tilt).dot(from_axis) - surface.distance_m;
}

/// A derivative with the parameter that it belongs to, to be checked by differences.
struct Registered {
  std::string name;
  std::function<double(const SurfaceMiss&)> analytic;
  std::function<void(SweepModel&, CalibrationSurface&, RangeObservation&, double)> change;
};

std::vector<Registered> registered() {
  using M = SweepModel;
  using S = CalibrationSurface;
  using O = RangeObservation;
  return {
      {"elevation", [](const SurfaceMiss& m) { return m.by_elevation; },
       [](M& m, S&, O&, double h) { m.elevation_offset_rad += h; }},
      {"crank", [](const SurfaceMiss& m) { return m.by_elevation * m.elevation_by_crank; },
       [](M& m, S&, O&, double h) { m.bars.crank_m += h; }},
      {"coupler", [](const SurfaceMiss& m) { return m.by_elevation * m.elevation_by_coupler; },
       [](M& m, S&, O&, double h) { m.bars.coupler_m += h; }},
      {"rocker", [](const SurfaceMiss& m) { return m.by_elevation * m.elevation_by_rocker; },
       [](M& m, S&, O&, double h) { m.bars.rocker_m += h; }},
      {"ground", [](const SurfaceMiss& m) { return m.by_elevation * m.elevation_by_ground; },
       [](M& m, S&, O&, double h) { m.bars.ground_m += h; }},
      {"zero", [](const SurfaceMiss& m) { return m.by_elevation * m.elevation_by_zero; },
       [](M& m, S&, O&, double h) { m.encoder.zero_rad += h; }},
      {"lever.forward", [](const SurfaceMiss& m) { return m.by_lever_forward; },
       [](M& m, S&, O&, double h) { m.mount.lever_forward_m += h; }},
      {"lever.up", [](const SurfaceMiss& m) { return m.by_lever_up; },
       [](M& m, S&, O&, double h) { m.mount.lever_up_m += h; }},
      {"roll", [](const SurfaceMiss& m) { return m.by_roll; },
       [](M& m, S&, O&, double h) { m.mount.sensor_roll_rad += h; }},
      {"yaw", [](const SurfaceMiss& m) { return m.by_yaw; },
       [](M& m, S&, O&, double h) { m.mount.sensor_yaw_rad += h; }},
      {"distance", [](const SurfaceMiss& m) { return m.by_distance; },
       [](M&, S& s, O&, double h) { s.distance_m += h; }},
      {"heading", [](const SurfaceMiss& m) { return m.by_heading; },
       [](M&, S& s, O&, double h) {
         if (s.kind == SurfaceKind::kWall) s.heading_rad += h;
       }},
      {"range", [](const SurfaceMiss& m) { return m.incidence; }, [](M&, S&, O& o, double h) { o.range_m += h; }},
  };
}

TEST(CalibrationResidual, MissIsThatOfTheMotion) {
  for (const CalibrationSurface& surface : surfaces()) {
    for (const RangeObservation& seen : observations()) {
      const std::optional<SurfaceMiss> miss = surface_miss(scanner(), surface, seen);
      ASSERT_TRUE(miss);
      EXPECT_NEAR(miss->miss_m, miss_by_motion(scanner(), surface, seen), 1e-12) << surface.name << seen.ticks;
    }
  }
}

TEST(CalibrationResidual, EveryDerivativeIsThatOfDifferences) {
  constexpr double kStep = 1e-6;
  for (const Registered& entry : registered()) {
    for (const CalibrationSurface& surface : surfaces()) {
      for (const RangeObservation& seen : observations()) {
        const auto moved = [&](double h) {
          SweepModel model = scanner();
          CalibrationSurface moved_surface = surface;
          RangeObservation moved_range = seen;
          entry.change(model, moved_surface, moved_range, h);
          return miss_by_motion(model, moved_surface, moved_range);
        };
        const double numeric = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
        const double analytic = entry.analytic(*surface_miss(scanner(), surface, seen));
        EXPECT_NEAR(analytic, numeric, 2e-6 * (1.0 + std::fabs(numeric)))
            << entry.name << " at " << surface.name << ", tick " << seen.ticks << ", bearing " << seen.bearing_rad;
      }
    }
  }
}

TEST(CalibrationResidual, TiltIsThatOfDifferences) {
  constexpr double kStep = 1e-6;
  for (const CalibrationSurface& surface : surfaces()) {
    for (const RangeObservation& seen : observations()) {
      const double numeric =
          (miss_by_motion(scanner(), surface, seen, kStep) - miss_by_motion(scanner(), surface, seen, -kStep)) /
          (2.0 * kStep);
      EXPECT_NEAR(surface_miss(scanner(), surface, seen)->by_tilt, numeric, 1e-6) << surface.name;
    }
  }
}

// (A1): 2 m at 60 degrees is 4 m; with a lever of 3 cm ahead and 2 cm down, (d - a cos + b sin) / cos.
TEST(CalibrationResidual, RangeToAWallIsTheCorrectedA1) {
  const CalibrationSurface wall{.name = "wall", .distance_m = 2.0};
  EXPECT_NEAR(*surface_range_m({}, wall, rad_from_deg(60.0), 0.0), 4.0, 1e-12);
  const NoddingMount mount{.lever_forward_m = 0.03, .lever_up_m = -0.02};
  EXPECT_NEAR(*surface_range_m(mount, wall, rad_from_deg(60.0), 0.0), (2.0 - 0.03 * 0.5 - 0.02 * std::sqrt(0.75)) / 0.5,
              1e-12);
  EXPECT_FALSE(surface_range_m({}, wall, rad_from_deg(90.0), 0.0));
  EXPECT_FALSE(surface_range_m({}, wall, rad_from_deg(100.0), 0.0));
}

TEST(CalibrationResidual, MissIsDefinedThroughNinetyDegrees) {
  SweepModel model = sweep_model_of_preset("paper-b");
  const CalibrationSurface wall{.name = "wall", .distance_m = 2.0};
  double last = 1e9;
  int beyond = 0;
  for (double ticks = 6000.0; ticks < 14000.0; ticks += 200.0) {
    const SurfaceMiss miss = *surface_miss(model, wall, {.ticks = ticks, .range_m = 5.0});
    EXPECT_NEAR(miss.miss_m, 5.0 * std::cos(miss.elevation_rad) - 2.0, 1e-12);
    beyond += miss.elevation_rad > 0.5 * kPi ? 1 : 0;
    last = std::min(last, miss.miss_m);
  }
  EXPECT_GT(beyond, 0);
  EXPECT_LT(last, -2.0);
}

TEST(CalibrationResidual, MeasuredElevationNeedsNoLinkage) {
  const NoddingMount mount{.lever_forward_m = 0.05, .lever_up_m = 0.02};
  for (const CalibrationSurface& surface : surfaces()) {
    for (const double elevation_deg : {-20.0, -8.0, 12.0, 35.0, 58.0}) {
      for (const double bearing : {0.0, 0.3}) {
        const double elevation = rad_from_deg(elevation_deg);
        const std::optional<double> range = surface_range_m(mount, surface, elevation, bearing);
        if (!range) continue;
        const RangeObservation seen{.bearing_rad = bearing, .range_m = *range};
        EXPECT_NEAR(measured_elevation_rad(mount, surface, seen, elevation + 0.05), elevation, 1e-9)
            << surface.name << " at " << elevation_deg;
      }
    }
  }
}

TEST(CalibrationResidual, ARangeTooShortHasTheElevationOfTheShortest) {
  const CalibrationSurface wall{.name = "wall", .distance_m = 2.0};
  EXPECT_NEAR(measured_elevation_rad({}, wall, {.range_m = 1.9}, 0.1), 0.0, 1e-12);
}

// The cosine of the angle from beam to normal, both as unit vectors of the level frame (x ahead, y left, z up).
TEST(CalibrationResidual, IncidenceIsTheCosineFromBeamToNormal) {
  const NoddingMount plain;
  for (const double elevation : {-0.7, 0.0, 0.4}) {
    for (const double bearing : {-0.5, 0.0, 0.8}) {
      const Point3 beam(std::cos(bearing) * std::cos(elevation), std::sin(bearing),
                        std::cos(bearing) * std::sin(elevation));
      for (const double heading : {-0.6, 0.0, 0.3}) {
        const CalibrationSurface wall{.name = "wall", .heading_rad = heading};
        EXPECT_NEAR(surface_incidence(plain, wall, elevation, bearing),
                    beam.dot(Point3(std::cos(heading), std::sin(heading), 0.0)), 1e-12);
      }
      EXPECT_NEAR(surface_incidence(plain, {.name = "floor", .kind = SurfaceKind::kFloor}, elevation, bearing),
                  -beam.z(), 1e-12);
      EXPECT_NEAR(surface_incidence(plain, {.name = "above", .kind = SurfaceKind::kCeiling}, elevation, bearing),
                  beam.z(), 1e-12);
    }
  }
}

TEST(CalibrationResidual, NothingWhereTheLoopDoesNotClose) {
  SweepModel model = scanner();
  model.bars.coupler_m = 0.4;
  EXPECT_FALSE(surface_miss(model, surfaces().front(), observations().front()));
}

}  // namespace
}  // namespace gdtslam::calib
