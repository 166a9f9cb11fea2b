// Matrices and vectors of the tangents of planar poses (x, y, theta). Every product is written out in a fixed order, so
// that no result depends on how a library vectorises. Thread-safe, constant time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

using Tangent2 = std::array<double, 3>;

inline double square(double value) { return value * value; }
/// Length of the translation.
inline double translation_length(const Pose2& T) { return std::sqrt(T.x_m * T.x_m + T.y_m * T.y_m); }

/// A 3 x 3 matrix, row-major.
struct Matrix3 {
  std::array<double, 9> m{};

  double& operator()(int row, int column) { return m[element_index(row, column)]; }
  double operator()(int row, int column) const { return m[element_index(row, column)]; }
  static std::size_t element_index(int row, int column) {
    return 3U * static_cast<std::size_t>(row) + static_cast<std::size_t>(column);
  }
  static Matrix3 diagonal(double a, double b, double c) { return {{a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c}}; }
  static Matrix3 identity() { return diagonal(1.0, 1.0, 1.0); }

  Matrix3& operator+=(const Matrix3& other) {
    for (std::size_t i = 0; i < 9; ++i) m[i] += other.m[i];
    return *this;
  }
  Matrix3& operator-=(const Matrix3& other) {
    for (std::size_t i = 0; i < 9; ++i) m[i] -= other.m[i];
    return *this;
  }
  friend Matrix3 operator*(double factor, Matrix3 matrix) {
    for (double& value : matrix.m) value *= factor;
    return matrix;
  }
  friend bool operator==(const Matrix3&, const Matrix3&) = default;
};

inline Matrix3 operator+(Matrix3 a, const Matrix3& b) { return a += b; }

inline Matrix3 transposed(const Matrix3& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}

inline Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 product;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) product(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
  }
  return product;
}
/// a b^T.
inline Matrix3 times_transposed(const Matrix3& a, const Matrix3& b) { return a * transposed(b); }
/// a^T b.
inline Matrix3 transposed_times(const Matrix3& a, const Matrix3& b) { return transposed(a) * b; }

inline Tangent2 operator*(const Matrix3& a, const Tangent2& v) {
  return {a(0, 0) * v[0] + a(0, 1) * v[1] + a(0, 2) * v[2], a(1, 0) * v[0] + a(1, 1) * v[1] + a(1, 2) * v[2],
          a(2, 0) * v[0] + a(2, 1) * v[1] + a(2, 2) * v[2]};
}
inline double dot(const Tangent2& a, const Tangent2& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/// a b^T.
inline Matrix3 outer(const Tangent2& a, const Tangent2& b) {
  return {{a[0] * b[0], a[0] * b[1], a[0] * b[2], a[1] * b[0], a[1] * b[1], a[1] * b[2], a[2] * b[0], a[2] * b[1],
           a[2] * b[2]}};
}
/// v^T a v.
inline double squared_norm(const Matrix3& a, const Tangent2& v) { return dot(v, a * v); }

inline void add(Tangent2& sum, const Tangent2& v) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] += v[i];
}
inline void subtract(Tangent2& sum, const Tangent2& v) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] -= v[i];
}

/// The lower triangular l with l l^T = a, for a symmetric and positive definite; if a is not, the diagonal of l has a
/// zero or a value that is not finite.
inline Matrix3 cholesky(const Matrix3& a) {
  Matrix3 l;
  l(0, 0) = std::sqrt(a(0, 0));
  l(1, 0) = a(1, 0) / l(0, 0);
  l(2, 0) = a(2, 0) / l(0, 0);
  l(1, 1) = std::sqrt(a(1, 1) - l(1, 0) * l(1, 0));
  l(2, 1) = (a(2, 1) - l(2, 0) * l(1, 0)) / l(1, 1);
  l(2, 2) = std::sqrt(a(2, 2) - l(2, 0) * l(2, 0) - l(2, 1) * l(2, 1));
  return l;
}
/// l^-1 v for lower triangular l.
inline Tangent2 solve_lower(const Matrix3& l, const Tangent2& v) {
  const double a = v[0] / l(0, 0);
  const double b = (v[1] - l(1, 0) * a) / l(1, 1);
  return {a, b, (v[2] - l(2, 0) * a - l(2, 1) * b) / l(2, 2)};
}
/// l^-T v.
inline Tangent2 solve_lower_transposed(const Matrix3& l, const Tangent2& v) {
  const double c = v[2] / l(2, 2);
  const double b = (v[1] - l(2, 1) * c) / l(1, 1);
  return {(v[0] - l(1, 0) * b - l(2, 0) * c) / l(0, 0), b, c};
}
/// a l^-T for lower triangular l: each row of a solved.
inline Matrix3 over_transposed(const Matrix3& a, const Matrix3& l) {
  Matrix3 result;
  for (int i = 0; i < 3; ++i) {
    const Tangent2 row = solve_lower(l, {a(i, 0), a(i, 1), a(i, 2)});
    for (int j = 0; j < 3; ++j) result(i, j) = row[static_cast<std::size_t>(j)];
  }
  return result;
}
/// Inverse of a symmetric and positive definite matrix.
inline Matrix3 inverse(const Matrix3& a) {
  const Matrix3 l = cholesky(a);
  Matrix3 result;
  for (int j = 0; j < 3; ++j) {
    Tangent2 unit{};
    unit[static_cast<std::size_t>(j)] = 1.0;
    const Tangent2 column = solve_lower_transposed(l, solve_lower(l, unit));
    for (int i = 0; i < 3; ++i) result(i, j) = column[static_cast<std::size_t>(i)];
  }
  return result;
}

/// Eigenvalues of a symmetric matrix, in no order, and their unit eigenvectors as columns.
struct Eigen3 {
  Tangent2 values{};
  Matrix3 vectors = Matrix3::identity();
};

/// By Jacobi's rotations, one pair of axes after the other [GolubVanLoan2013, section 8.5.2].
inline Eigen3 eigen_of_symmetric(Matrix3 a) {
  constexpr int kMostSweeps = 32;
  constexpr double kNothing = 1.0e-300;
  Eigen3 result;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    const double off = a(0, 1) * a(0, 1) + a(0, 2) * a(0, 2) + a(1, 2) * a(1, 2);
    const double on = a(0, 0) * a(0, 0) + a(1, 1) * a(1, 1) + a(2, 2) * a(2, 2);
    if (off <= 1.0e-32 * on + kNothing) break;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (a(p, q) == 0.0) continue;
      const double half = 0.5 * (a(q, q) - a(p, p)) / a(p, q);
      const double t = (half < 0.0 ? -1.0 : 1.0) / (std::fabs(half) + std::sqrt(half * half + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0);
      Matrix3 turn = Matrix3::identity();
      turn(p, p) = turn(q, q) = c;
      turn(p, q) = t * c;
      turn(q, p) = -t * c;
      a = transposed_times(turn, a * turn);
      result.vectors = result.vectors * turn;
    }
  }
  result.values = {a(0, 0), a(1, 1), a(2, 2)};
  return result;
}

/// The matrix with these eigenvectors, and f of each eigenvalue.
template <class Function>
Matrix3 with_eigenvalues(const Eigen3& eigen, const Function& f) {
  const Matrix3 scaled = eigen.vectors * Matrix3::diagonal(f(eigen.values[0]), f(eigen.values[1]), f(eigen.values[2]));
  return times_transposed(scaled, eigen.vectors);
}

/// Standard deviation of the position in its least sure direction, from a covariance of (x, y, theta).
inline double position_sigma(const Matrix3& covariance) {
  return position_sigma(covariance(0, 0), covariance(0, 1), covariance(1, 1));
}

/// adjoint(T) of pose.hpp.
inline Matrix3 adjoint_matrix(const Pose2& T) {
  const Eigen::Matrix3d a = adjoint(T);
  return {{a(0, 0), a(0, 1), a(0, 2), a(1, 0), a(1, 1), a(1, 2), a(2, 0), a(2, 1), a(2, 2)}};
}
inline Tangent2 log_tangent(const Pose2& T) {
  const Eigen::Vector3d v = log_se2(T);
  return {v.x(), v.y(), v.z()};
}
inline Pose2 exp_tangent(const Tangent2& v) { return exp_se2({v[0], v[1], v[2]}); }

}  // namespace gdtslam
