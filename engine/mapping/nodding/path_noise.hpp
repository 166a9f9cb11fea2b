// Estimates the noise of the odometry between two fixes, of the fixes, and of the points in between, during the log:
// the odometry by its error at the next fix, the points by the pose half way that they prefer. Variance components with
// Student's t for outliers [Lange1989]; the configuration counts as a few measurements. Not thread-safe. Cost: linear
// in the nodes.
#pragma once

#include <cstddef>
#include <span>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "pose_path.hpp"

namespace gdtslam {

/// A variance as a factor of known shapes: the mean of the observed squares, as far as they belong to it.
struct VarianceComponent {
  double squares = 0.0;
  double count = 0.0;
  [[nodiscard]] double value() const { return squares / count; }
};

/// Information of points about a pose: the inverse of the covariance of (x, y, theta), robot frame, and its product
/// with the motion away from the pose that the points prefer.
struct PointsView {
  Matrix3 information;
  Tangent2 away{};
};

/// Points do not constrain directions in which they have less information than this, about a metre or a radian.
inline constexpr double kLeastViewInformation = 1.0;
/// Weight of a residual of three numbers with the given chi2, by Student's t with four degrees of freedom.
inline double student_weight(double chi2) { return 7.0 / (4.0 + chi2); }

/// Radians of turn that count like a metre of way for the error of the odometry's heading.
inline constexpr double kTurnsPerMetre = 0.36;

class PathNoise {
 public:
  explicit PathNoise(const SmootherConfig& config);

  /// Learns from two fixes; `nodes` has the odometry of the scans in between. A stretch without motion is ignored.
  void take_closing(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes);
  /// Learns from the points' information about the pose of nodes[at], weighted by the configuration, at the pose by the
  /// odometry.
  void take_view(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes, std::size_t at,
                 const PointsView& view);
  /// The configuration with the estimated standard deviations. That of a point grows with the number of the smoother's
  /// stations that have the same view, because an error of a view is common to all of them.
  [[nodiscard]] SmootherConfig found() const;

 private:
  /// Contribution of a stretch of the path to the covariance of its end, in the end's frame, for variances of one.
  struct Growth {
    double way_m = 0.0;
    Matrix3 about;  ///< by turns
  };
  static Growth growth(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes);
  [[nodiscard]] Matrix3 covariance(const Growth& growth) const;

  SmootherConfig config_;
  VarianceComponent way_;     ///< m^2 a metre
  VarianceComponent turn_;    ///< rad^2 a radian
  VarianceComponent fix_;     ///< m^2, of the difference of two fixes
  VarianceComponent points_;  ///< factor of the configured variance
};

}  // namespace gdtslam
