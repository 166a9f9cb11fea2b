// How far the odometry between two fixes, the fixes, and the points on the way are off, estimated as the log goes: the
// odometry by where it ends at the next fix, the points by where they would have the robot half way. Variance
// components with Student's t for what is wrong altogether [Lange1989]; what the configuration says counts as a few
// measurements. Not thread-safe. Cost: linear in the nodes.
#pragma once

#include <cstddef>
#include <span>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "pose_path.hpp"

namespace gdtslam {

/// A variance that is a scale of known shapes: the mean of squares that were seen, in the share that is its own.
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

/// Directions in which points say less than that, about a metre or a radian, are not held by them.
inline constexpr double kLeastViewInformation = 1.0;
/// Weight of a residual of three numbers with the given chi2, by Student's t with four degrees of freedom.
inline double student_weight(double chi2) { return 7.0 / (4.0 + chi2); }

/// Turns that a metre of way counts as where the odometry's heading errs.
inline constexpr double kTurnsPerMetre = 0.36;

class PathNoise {
 public:
  explicit PathNoise(const SmootherConfig& config);

  /// Between two fixes, `nodes` with the odometry of the scans between. A stretch without motion tells nothing.
  void take_closing(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes);
  /// Takes the points' information about the pose of nodes[at], weighted by the configuration, where the odometry put
  /// it.
  void take_view(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes, std::size_t at,
                 const PointsView& view);
  /// The configuration with the standard deviations that were found; a point's holds as many stations of the smoother
  /// as see the same, because what is wrong with a view is wrong with all of them.
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
