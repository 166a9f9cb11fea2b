// A turn whose heading goes as 3u^2 - 2u^3 of the share u of its length: the curvature is zero at both ends, at most
// 1.5 * angle / length, and changes by at most 6 * angle / length^2. The path has no closed form; it is integrated once
// by Gauss-Legendre quadrature at unit length, whose error is below 1e-12.
#pragma once

#include <array>

#include "gdtslam/core/pose.hpp"

namespace gdtslam::sim {

class SmoothTurn {
 public:
  /// Starts at the origin along x; `cut_m` is the distance from either end to the corner of the two tangents.
  SmoothTurn(double angle_rad, double cut_m);

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double angle_rad() const { return angle_rad_; }
  [[nodiscard]] double heading_at(double share) const;
  /// Turn per metre.
  [[nodiscard]] double curvature_at(double share) const;
  [[nodiscard]] Point2 position_at(double share) const;

 private:
  static constexpr int kNodes = 32;
  [[nodiscard]] Point2 integrated(double from_share, double to_share) const;

  double angle_rad_;
  double length_m_ = 1.0;
  std::array<Point2, kNodes + 1> at_node_;  ///< at unit length
};

}  // namespace gdtslam::sim
