#include "gdtslam/core/differential_drive.hpp"

#include "elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "sinc.hpp"

namespace gdtslam {

// The axle's middle moves along an arc of length s that turns by theta; O swings about it with the lever c:
// x = s sinc(a) cos(a) + c (cos(theta) - 1), y = s sinc(a) sin(a) + c sin(theta), a = theta / 2.
Pose2 wheel_displacement(const DifferentialDrive& drive, double left_m, double right_m) {
  const double arc_m = 0.5 * (left_m + right_m);
  const double theta_rad = (right_m - left_m) / drive.track_width_m;
  const HalfTurn half = half_turn(0.5 * theta_rad);
  const double chord_m = arc_m * half.sinc;
  const double swing_m = 2.0 * drive.centre_ahead_of_axle_m * half.sin;
  return {chord_m * half.cos - swing_m * half.sin, chord_m * half.sin + swing_m * half.cos, wrap_angle(theta_rad)};
}

Pose2 wheel_displacement_literal(const DifferentialDrive& drive, double left_m, double right_m) {
  const double radius_m = drive.track_width_m * left_m / (right_m - left_m);
  const double theta_rad = left_m / radius_m;
  const SinCos<double> angle = sin_cos(theta_rad);
  return {radius_m * angle.cos, radius_m * angle.sin, wrap_angle(theta_rad)};
}

}  // namespace gdtslam
