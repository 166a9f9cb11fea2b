// Poses and tangents for the laws of SE(2) and SE(3), with the hard places hit often, and a matrix exponential by its
// series in long double as an oracle.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <type_traits>

#include <rapidcheck.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/pose3.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam::test {

/// Uniform in [-limit, limit]. Not shrunk: a real number has no simpler one, and trying takes minutes.
inline rc::Gen<double> real(double limit) {
  return rc::gen::noShrink(
      rc::gen::map(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::int64_t>()),
                   [limit](std::int64_t bits) { return limit * (static_cast<double>(bits) * 0x1p-63); }));
}

/// Either sign, its magnitude uniform on a logarithmic scale from 10^-18 to the limit.
inline rc::Gen<double> of_any_scale(double limit) {
  return rc::gen::map(rc::gen::pair(real(1.0), real(9.0)), [limit](const auto& values) {
    return std::copysign(limit * std::pow(10.0, values.second - 9.0), values.first);
  });
}

/// An angle in (-pi, pi): zero, of any scale, close to half a turn, or anywhere.
inline rc::Gen<double> angle() {
  return rc::gen::oneOf(
      rc::gen::just(0.0), of_any_scale(3.0),
      rc::gen::map(real(1.0),
                   [](double x) { return std::copysign(std::numbers::pi - 1e-12 - std::fabs(x) * 1e-6, x); }),
      real(3.14));
}

/// A length: zero, of any scale, or up to 100 m.
inline rc::Gen<double> length() {
  return rc::gen::oneOf(rc::gen::just(0.0), of_any_scale(100.0), real(1.0), real(100.0));
}

inline rc::Gen<Pose2> pose2() {
  return rc::gen::map(rc::gen::tuple(length(), length(), angle()), [](const auto& values) {
    return Pose2{std::get<0>(values), std::get<1>(values), std::get<2>(values)};
  });
}

inline rc::Gen<Eigen::Vector3d> tangent2() {
  return rc::gen::map(rc::gen::tuple(length(), length(), angle()), [](const auto& values) {
    return Eigen::Vector3d(std::get<0>(values), std::get<1>(values), std::get<2>(values));
  });
}

inline rc::Gen<Eigen::Vector3d> point3() {
  return rc::gen::map(rc::gen::tuple(length(), length(), length()), [](const auto& values) {
    return Eigen::Vector3d(std::get<0>(values), std::get<1>(values), std::get<2>(values));
  });
}

/// A rotation vector shorter than pi.
inline rc::Gen<Eigen::Vector3d> rotation_vector() {
  return rc::gen::map(rc::gen::tuple(real(1.0), real(1.0), real(1.0), angle()), [](const auto& values) {
    const Eigen::Vector3d axis(std::get<0>(values), std::get<1>(values), std::get<2>(values));
    const Eigen::Vector3d unit = axis.norm() > 1e-3 ? Eigen::Vector3d(axis.normalized()) : Eigen::Vector3d::UnitX();
    return Eigen::Vector3d(unit * std::get<3>(values));
  });
}

inline rc::Gen<Tangent3> tangent3() {
  return rc::gen::map(rc::gen::pair(point3(), rotation_vector()), [](const auto& values) {
    Tangent3 tangent;
    tangent << values.first, values.second;
    return tangent;
  });
}

/// Rotations by Eigen's angle and axis, not by the code under test.
inline rc::Gen<Pose3> pose3() {
  return rc::gen::map(rc::gen::pair(point3(), rotation_vector()), [](const auto& values) {
    const double angle_rad = values.second.norm();
    const Eigen::Vector3d axis =
        angle_rad > 0.0 ? Eigen::Vector3d(values.second / angle_rad) : Eigen::Vector3d::UnitX();
    return Pose3{values.first, Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis)).normalized()};
  });
}

/// PoseNear as a plain truth value, metres and radians.
template <class Pose>
bool near_pose(const Pose& found, const std::type_identity_t<Pose>& expected, double metres, double radians) {
  return testing::Matches(PoseNear(expected, metres, radians * (180.0 / std::numbers::pi)))(found);
}

/// exp of a square matrix of norm up to some hundreds: the series of a 2^-k-th of it, squared k times.
template <class Matrix>
Matrix matrix_exponential(const Matrix& exponent) {
  // The nilpotent part, the translation, may be long; it enters linearly and needs no more scaling than the rotation.
  constexpr int kSquarings = 6;
  const Matrix small = exponent / 64.0L;
  Matrix sum = Matrix::Identity();
  Matrix term = Matrix::Identity();
  for (int k = 1; k <= 20; ++k) {
    term = (term * small / static_cast<long double>(k)).eval();
    sum += term;
  }
  for (int k = 0; k < kSquarings; ++k) {
    sum = (sum * sum).eval();
  }
  return sum;
}

}  // namespace gdtslam::test
