#include "gdtslam/core/pose3.hpp"

#include <cmath>

#include "elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

double dot(const Vector3d& a, const Vector3d& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }

Vector3d cross(const Vector3d& a, const Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

double norm(const Vector3d& a) { return std::sqrt(dot(a, a)); }

Vector3d vector_part(const Quaterniond& q) { return {q.x(), q.y(), q.z()}; }

Quaterniond conjugate(const Quaterniond& q) { return {q.w(), -q.x(), -q.y(), -q.z()}; }

// Rounding moves a product slightly off the unit sphere; without normalisation that grows along a chain of poses.
Quaterniond normalized(const Quaterniond& q) {
  const double length = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

Quaterniond product(const Quaterniond& a, const Quaterniond& b) {
  return normalized({a.w() * b.w() - a.x() * b.x() - a.y() * b.y() - a.z() * b.z(),
                     a.w() * b.x() + a.x() * b.w() + a.y() * b.z() - a.z() * b.y(),
                     a.w() * b.y() - a.x() * b.z() + a.y() * b.w() + a.z() * b.x(),
                     a.w() * b.z() + a.x() * b.y() - a.y() * b.x() + a.z() * b.w()});
}

// v + 2 w (q x v) + 2 q x (q x v).
Vector3d rotate(const Quaterniond& q, const Vector3d& v) {
  const Vector3d axis = vector_part(q);
  const Vector3d turn = 2.0 * cross(axis, v);
  return v + q.w() * turn + cross(axis, turn);
}

// Factors by which the rotation by an angle a changes the translation along a screw.
struct ScrewFactors {
  double once;   ///< (1 - cos a) / a^2
  double twice;  ///< (a - sin a) / a^3
};

// Both are used times a^2, so cancellation in the closed form of the second costs only one rounding of the result. The
// series only avoids 0/0.
ScrewFactors screw_factors(double angle_rad) {
  const double sq_angle = angle_rad * angle_rad;
  const double half = angle_rad == 0.0 ? 0.5 : sin_cos(0.5 * angle_rad).sin / angle_rad;
  const double twice = angle_rad < 0.01 ? (1.0 - sq_angle / 20.0 * (1.0 - sq_angle / 42.0)) / 6.0
                                        : (angle_rad - sin_cos(angle_rad).sin) / (sq_angle * angle_rad);
  return {2.0 * half * half, twice};
}

}  // namespace

bool Pose3::is_finite() const {
  return std::isfinite(translation_m.x()) && std::isfinite(translation_m.y()) && std::isfinite(translation_m.z()) &&
         std::isfinite(rotation.w()) && std::isfinite(rotation.x()) && std::isfinite(rotation.y()) &&
         std::isfinite(rotation.z());
}

Pose3 operator*(const Pose3& T_a_b, const Pose3& T_b_c) {
  return {T_a_b * T_b_c.translation_m, product(T_a_b.rotation, T_b_c.rotation)};
}

Point3 operator*(const Pose3& T_a_b, const Point3& point_b) {
  return T_a_b.translation_m + rotate(T_a_b.rotation, point_b);
}

Pose3 inverse(const Pose3& T_a_b) {
  const Quaterniond back = conjugate(normalized(T_a_b.rotation));
  return {-rotate(back, T_a_b.translation_m), back};
}

// The translations are subtracted before they are turned, as in the plane.
Pose3 between(const Pose3& T_w_a, const Pose3& T_w_b) {
  const Quaterniond back = conjugate(normalized(T_w_a.rotation));
  return {rotate(back, T_w_b.translation_m - T_w_a.translation_m), product(back, T_w_b.rotation)};
}

Quaterniond exp_so3(const Vector3d& rotation_vector_rad) {
  const double angle_rad = norm(rotation_vector_rad);
  const SinCos<double> half = sin_cos(0.5 * angle_rad);
  const double scale = angle_rad == 0.0 ? 0.5 : half.sin / angle_rad;
  return normalized(
      {half.cos, scale * rotation_vector_rad.x(), scale * rotation_vector_rad.y(), scale * rotation_vector_rad.z()});
}

Vector3d log_so3(const Quaterniond& rotation) {
  // q and -q are one rotation; this takes the one with the smaller angle.
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Vector3d axis = sign * vector_part(rotation);
  const double sine = norm(axis);
  const double cosine = sign * rotation.w();
  return (sine == 0.0 ? 2.0 / cosine : 2.0 * atan2(sine, cosine) / sine) * axis;
}

Matrix3d rotation_matrix(const Quaterniond& rotation) {
  const Vector3d x = rotate(rotation, Vector3d::UnitX());
  const Vector3d y = rotate(rotation, Vector3d::UnitY());
  const Vector3d z = rotate(rotation, Vector3d::UnitZ());
  Matrix3d result;
  result << x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z();
  return result;
}

// translation = V v with V = 1 + (1 - cos a)/a^2 [w] + (a - sin a)/a^3 [w]^2.
Pose3 exp_se3(const Tangent3& tangent) {
  const Vector3d shift = tangent.head<3>();
  const Vector3d turn = tangent.tail<3>();
  const ScrewFactors factors = screw_factors(norm(turn));
  const Vector3d once = cross(turn, shift);
  return {shift + factors.once * once + factors.twice * cross(turn, once), exp_so3(turn)};
}

// The inverse of V is 1 - [w]/2 + (1 - (a/2) cot(a/2))/a^2 [w]^2; again the last factor is used times a^2.
Tangent3 log_se3(const Pose3& T) {
  const Vector3d turn = log_so3(T.rotation);
  const double half_rad = 0.5 * norm(turn);
  const SinCos<double> half = sin_cos(half_rad);
  const double factor =
      half_rad < 1e-4 ? 1.0 / 12.0 : (1.0 - half_rad * half.cos / half.sin) / (4.0 * half_rad * half_rad);
  const Vector3d once = cross(turn, T.translation_m);
  Tangent3 tangent;
  tangent << T.translation_m - 0.5 * once + factor * cross(turn, once), turn;
  return tangent;
}

// [R, [t] R; 0, R].
Matrix6 adjoint(const Pose3& T) {
  const Matrix3d R = rotation_matrix(T.rotation);
  Matrix6 result = Matrix6::Zero();
  for (int column = 0; column < 3; ++column) {
    const Vector3d axis = R.col(column);
    result.block<3, 1>(0, column) = axis;
    result.block<3, 1>(3, column + 3) = axis;
    result.block<3, 1>(0, column + 3) = cross(T.translation_m, axis);
  }
  return result;
}

Pose3 embed(const Pose2& pose, double height_m) {
  const SinCos<double> half = sin_cos(0.5 * pose.theta_rad);
  return {{pose.x_m, pose.y_m, height_m}, Quaterniond(half.cos, 0.0, 0.0, half.sin)};
}

Pose2 project(const Pose3& pose) {
  const Vector3d forward = rotate(pose.rotation, Vector3d::UnitX());
  return {pose.translation_m.x(), pose.translation_m.y(), wrap_angle(atan2(forward.y(), forward.x()))};
}

}  // namespace gdtslam
