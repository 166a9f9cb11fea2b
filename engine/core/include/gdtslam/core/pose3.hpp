// SE(3) poses: metres, x forward, y left, z up (REP-103), rotation as a unit quaternion. T_a_b maps points of frame b
// into frame a, T_a_c = T_a_b * T_b_c. Tangent order is (x, y, z, rx, ry, rz): translation first, then the rotation
// vector in radians; perturbations act on the right. Conventions and names of the Jacobians after [Sola2018]. Every
// product is written out, so that no result depends on how Eigen vectorises. Thread-safe, constant time.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A point or a vector of space, metres.
using Point3 = Eigen::Vector3d;
/// Tangent of SE(3): (x, y, z, rx, ry, rz).
using Tangent3 = Eigen::Matrix<double, 6, 1>;
/// Linear map of tangents of SE(3).
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rigid motion of space. Every operation below returns a unit quaternion.
struct Pose3 {
  Point3 translation_m = Point3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

  [[nodiscard]] bool is_finite() const;
  friend bool operator==(const Pose3& a, const Pose3& b) {
    return a.translation_m == b.translation_m && a.rotation.coeffs() == b.rotation.coeffs();
  }
};

/// T_a_c = T_a_b * T_b_c.
Pose3 operator*(const Pose3& T_a_b, const Pose3& T_b_c);
/// The point of frame b in frame a.
Point3 operator*(const Pose3& T_a_b, const Point3& point_b);
/// T_b_a.
Pose3 inverse(const Pose3& T_a_b);
/// T_a_b from two poses in one frame: inverse(T_w_a) * T_w_b.
Pose3 between(const Pose3& T_w_a, const Pose3& T_w_b);

/// exp: tangent to motion along a screw.
Pose3 exp_se3(const Tangent3& tangent);
/// log: inverse of exp_se3 for rotations by less than pi; at pi, one of the two rotation vectors.
Tangent3 log_se3(const Pose3& T);
/// Adjoint: T * exp(v) = exp(Ad_T v) * T.
Matrix6 adjoint(const Pose3& T);

/// The unit quaternion of a rotation vector (axis times angle, radians).
Eigen::Quaterniond exp_so3(const Eigen::Vector3d& rotation_vector_rad);
/// The rotation vector of a unit quaternion, of length at most pi.
Eigen::Vector3d log_so3(const Eigen::Quaterniond& rotation);
/// The rotation as a matrix.
Eigen::Matrix3d rotation_matrix(const Eigen::Quaterniond& rotation);

/// A pose of the plane at a height: yaw about z, no roll, no pitch.
Pose3 embed(const Pose2& pose, double height_m = 0.0);
/// The plane's part of a pose: x, y and the yaw of the rotated x axis.
Pose2 project(const Pose3& pose);

}  // namespace gdtslam
