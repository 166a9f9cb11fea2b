// Residual of one range to a surface of known kind: equation (A1) of the paper, as in docs/paper.md, for any flat
// surface and any beam, with every derivative. A forward beam raised by theta meets a wall at distance d if r
// cos(theta) + a cos(theta) - b sin(theta) = d, with the lever a forward and b up. The miss is the left side minus the
// right one. Unlike the range, it is defined through 90 degrees. SI units, radians, frame `level` of core/nodding.hpp
// moved to the nodding axis. Thread-safe, constant time.
#pragma once

#include <optional>

#include "gdtslam/calib/calibration.hpp"

namespace gdtslam::calib {

/// The miss of an observation and its derivatives by every parameter that a calibration estimates or assumes.
struct SurfaceMiss {
  double miss_m = 0.0;     ///< distance of the measured point beyond the surface, along the normal
  double incidence = 0.0;  ///< cosine of the angle between beam and normal: d miss / d range
  double elevation_rad = 0.0;

  // Derivatives of the elevation, by bars (rad per metre), by the encoder's zero and by the offset.
  double elevation_by_crank = 0.0;
  double elevation_by_coupler = 0.0;
  double elevation_by_rocker = 0.0;
  double elevation_by_ground = 0.0;
  double elevation_by_zero = 0.0;
  double elevation_by_offset = 1.0;
  // Derivatives of the miss; those by bars, zero and offset follow through the elevation.
  double by_elevation = 0.0;
  double by_lever_forward = 0.0;
  double by_lever_up = 0.0;
  double by_roll = 0.0;
  double by_yaw = 0.0;
  double by_distance = 0.0;
  double by_heading = 0.0;
  double by_tilt = 0.0;  ///< tilt: a wall's upper part away from the scanner, floor and ceiling rising ahead
};

/// Empty if the loop does not close or the rocker's angle has no derivative.
std::optional<SurfaceMiss> surface_miss(const SweepModel& model, const CalibrationSurface& surface,
                                        const RangeObservation& observation);

/// The range at which a beam of this elevation meets the surface; empty if the beam points away from it.
std::optional<double> surface_range_m(const NoddingMount& mount, const CalibrationSurface& surface,
                                      double elevation_rad, double bearing_rad);

/// Cosine of the angle between a beam of this elevation and the surface's normal.
double surface_incidence(const NoddingMount& mount, const CalibrationSurface& surface, double elevation_rad,
                         double bearing_rad);

/// The elevation that follows from the range without the linkage. Of the two solutions (a wall looks the same above and
/// below) it is the one closer to `near_rad`. A range too short for the surface gives the elevation of the shortest
/// one.
double measured_elevation_rad(const NoddingMount& mount, const CalibrationSurface& surface,
                              const RangeObservation& observation, double near_rad);

}  // namespace gdtslam::calib
