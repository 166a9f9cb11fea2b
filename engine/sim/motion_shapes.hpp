// Parts of the motion along waypoints: speed profiles and turns. Constant time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "gdtslam/core/pose.hpp"

namespace gdtslam::sim {

struct ProfileState {
  double distance = 0.0;
  double rate = 0.0;
};

/// Trapezoid of the rate over time. Needs |end^2 - start^2| <= 2 * acceleration * distance; the peak is lowered if
/// needed.
class SpeedProfile {
 public:
  SpeedProfile(double distance, double start_rate, double end_rate, double peak_rate, double acceleration)
      : start_(start_rate), end_(end_rate), acceleration_(acceleration) {
    const double reachable = 0.5 * (2.0 * acceleration * distance + start_ * start_ + end_ * end_);
    peak_ = std::max({std::min(peak_rate, std::sqrt(reachable)), start_, end_});
    rise_s_ = (peak_ - start_) / acceleration;
    fall_s_ = (peak_ - end_) / acceleration;
    const double ramps = 0.5 * (start_ + peak_) * rise_s_ + 0.5 * (peak_ + end_) * fall_s_;
    cruise_s_ = peak_ > 0.0 ? std::max(0.0, distance - ramps) / peak_ : 0.0;
    distance_ = distance;
  }

  [[nodiscard]] double duration_s() const { return rise_s_ + cruise_s_ + fall_s_; }

  [[nodiscard]] ProfileState at(double time_s) const {
    if (time_s < rise_s_) {
      return {(start_ + 0.5 * acceleration_ * time_s) * time_s, start_ + acceleration_ * time_s};
    }
    const double left_s = duration_s() - time_s;
    if (left_s > fall_s_) {
      return {0.5 * (start_ + peak_) * rise_s_ + peak_ * (time_s - rise_s_), peak_};
    }
    // Measured from the end, so that the end is exact.
    const double before_end_s = std::max(0.0, left_s);
    return {distance_ - (end_ + 0.5 * acceleration_ * before_end_s) * before_end_s,
            end_ + acceleration_ * before_end_s};
  }

 private:
  double start_;
  double end_;
  double acceleration_;
  double peak_ = 0.0;
  double rise_s_ = 0.0;
  double cruise_s_ = 0.0;
  double fall_s_ = 0.0;
  double distance_ = 0.0;
};

/// A turn whose heading is 3u^2 - 2u^3 over the share u of its length: the curvature is zero at both ends, at most 1.5
/// * angle / length, and changes by at most 6 * angle / length^2. The path has no closed form; it is integrated once by
/// Gauss-Legendre quadrature at unit length, with an error below 1e-12.
class SmoothTurn {
 public:
  /// Starts at the origin along x; `cut_m` is the distance from either end to the intersection of the tangents.
  SmoothTurn(double angle_rad, double cut_m);

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double angle_rad() const { return angle_rad_; }
  [[nodiscard]] double heading_at(double share) const;
  /// Curvature, radians per metre.
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
