// Poses of the plane, angles, and the drive of a robot.
#include "gdtslam/core/pose.hpp"

#include <algorithm>
#include <cmath>

#include "elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {
namespace {

Point2 rotate(const SinCos<double>& angle, double x, double y) {
  return {angle.cos * x - angle.sin * y, angle.sin * x + angle.cos * y};
}

Point2 rotate_back(const SinCos<double>& angle, double x, double y) {
  return {angle.cos * x + angle.sin * y, angle.cos * y - angle.sin * x};
}

/// sin(a)/a with the sine and the cosine of the same angle, for an arc and its chord.
struct HalfTurn {
  double sin = 0.0;
  double cos = 1.0;
  double sinc = 1.0;  ///< sin(a) / a, 1 at 0
};

/// The chord of an arc that turns by 2a is the arc's length times sinc, pointing a to the left of the start.
HalfTurn half_turn(double a_rad) {
  const SinCos<double> value = sin_cos(a_rad);
  return {value.sin, value.cos, a_rad == 0.0 ? 1.0 : value.sin / a_rad};
}

}  // namespace

double wrap_angle(double angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) {
    return angle_rad;
  }
  // IEEE 754 remainder is exact, hence the same everywhere.
  const double wrapped_rad = std::remainder(angle_rad, kTwoPi);
  return wrapped_rad <= -kPi ? kPi : wrapped_rad;
}

bool Pose2::is_finite() const { return std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(theta_rad); }

PointMotion::PointMotion(const Pose2& T_a_b) : translation_(T_a_b.translation()) {
  const SinCos<double> angle = sin_cos(T_a_b.theta_rad);
  sin_ = angle.sin;
  cos_ = angle.cos;
}

Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c) {
  const Point2 turned = rotate(sin_cos(T_a_b.theta_rad), T_b_c.x_m, T_b_c.y_m);
  return {T_a_b.x_m + turned.x(), T_a_b.y_m + turned.y(), wrap_angle(T_a_b.theta_rad + T_b_c.theta_rad)};
}

Point2 operator*(const Pose2& T_a_b, const Point2& point_b) { return PointMotion(T_a_b)(point_b); }

Pose2 inverse(const Pose2& T_a_b) {
  const Point2 turned = rotate_back(sin_cos(T_a_b.theta_rad), T_a_b.x_m, T_a_b.y_m);
  return {-turned.x(), -turned.y(), wrap_angle(-T_a_b.theta_rad)};
}

// The translations are subtracted before they are turned, which is exact for two poses close together and far from the
// origin.
Pose2 between(const Pose2& T_w_a, const Pose2& T_w_b) {
  const Point2 turned = rotate_back(sin_cos(T_w_a.theta_rad), T_w_b.x_m - T_w_a.x_m, T_w_b.y_m - T_w_a.y_m);
  return {turned.x(), turned.y(), wrap_angle(T_w_b.theta_rad - T_w_a.theta_rad)};
}

// The arc's chord: V(theta) = sinc(theta/2) R(theta/2), with neither a series nor a cancellation near theta = 0.
Pose2 exp_se2(const Eigen::Vector3d& tangent) {
  const HalfTurn half = half_turn(0.5 * tangent.z());
  const Point2 chord = rotate({half.sin, half.cos}, tangent.x(), tangent.y());
  return {half.sinc * chord.x(), half.sinc * chord.y(), wrap_angle(tangent.z())};
}

Eigen::Vector3d log_se2(const Pose2& T) {
  const double theta_rad = wrap_angle(T.theta_rad);
  const HalfTurn half = half_turn(0.5 * theta_rad);
  const Point2 arc = rotate_back({half.sin, half.cos}, T.x_m, T.y_m);
  return {arc.x() / half.sinc, arc.y() / half.sinc, theta_rad};
}

Eigen::Matrix3d adjoint(const Pose2& T) {
  const SinCos<double> angle = sin_cos(T.theta_rad);
  Eigen::Matrix3d result;
  result << angle.cos, -angle.sin, T.y_m,  //
      angle.sin, angle.cos, -T.x_m,        //
      0.0, 0.0, 1.0;
  return result;
}

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

double position_sigma(double xx, double xy, double yy) {
  const double mean = 0.5 * (xx + yy);
  const double half = 0.5 * (xx - yy);
  return std::sqrt(std::fmax(0.0, mean + std::sqrt(half * half + xy * xy)));
}

double path_length_m(const Trajectory& trajectory, std::span<const std::size_t> drives) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    if (std::binary_search(drives.begin(), drives.end(), i)) continue;
    length_m += between(trajectory[i - 1].T_map_base, trajectory[i].T_map_base).translation().norm();
  }
  return length_m;
}

}  // namespace gdtslam
