// SE(2) poses: metres and radians, x forward, y left, yaw counter-clockwise (REP-103).
// A variable T_a_b maps points of frame b into frame a, so T_a_c = T_a_b * T_b_c. Tangent order is (x, y, theta) and
// perturbations act on the right (docs/conventions in docs/numerics.md). Thread-safe, constant time.
#pragma once

#include <Eigen/Core>

namespace gdtslam {

/// A point or a vector of the plane, metres.
using Point2 = Eigen::Vector2d;

/// Rigid motion of the plane; paper equations (2) and (3).
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;  ///< any value on input; every operation below returns it in (-pi, pi]

  [[nodiscard]] Point2 translation() const { return {x_m, y_m}; }
  [[nodiscard]] bool is_finite() const;
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// A motion for many points, with its sine and cosine; the bits of T_a_b * point.
class PointMotion {
 public:
  explicit PointMotion(const Pose2& T_a_b);
  /// The point of frame b in frame a.
  Point2 operator()(const Point2& point_b) const { return translation_ + turned(point_b); }
  /// The vector of frame b in frame a.
  [[nodiscard]] Point2 turned(const Point2& vector_b) const {
    return {cos_ * vector_b.x() - sin_ * vector_b.y(), sin_ * vector_b.x() + cos_ * vector_b.y()};
  }

 private:
  Point2 translation_;
  double sin_ = 0.0;
  double cos_ = 1.0;
};

/// T_a_c = T_a_b * T_b_c, paper equation (3).
Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c);
/// The point of frame b in frame a.
Point2 operator*(const Pose2& T_a_b, const Point2& point_b);
/// T_b_a.
Pose2 inverse(const Pose2& T_a_b);
/// T_a_b from two poses in one frame: inverse(T_w_a) * T_w_b.
Pose2 between(const Pose2& T_w_a, const Pose2& T_w_b);

/// exp: tangent (x, y, theta) to motion along a circular arc.
Pose2 exp_se2(const Eigen::Vector3d& tangent);
/// log: inverse of exp_se2 for |theta| < pi.
Eigen::Vector3d log_se2(const Pose2& T);
/// Adjoint: T * exp(v) = exp(Ad_T v) * T.
Eigen::Matrix3d adjoint(const Pose2& T);

/// Largest standard deviation in any direction, from the variances and the covariance of x and y.
double position_sigma(double xx, double xy, double yy);

/// Uncertainty of a pose within a map: covariance of (x, y, theta) along the map's axes, without the rigid motion of
/// the map as a whole.
struct PoseCovariance {
  double xx = 0.0;  ///< m^2
  double xy = 0.0;
  double xt = 0.0;  ///< m rad
  double yy = 0.0;
  double yt = 0.0;
  double tt = 0.0;  ///< rad^2
  /// Standard deviation of the position in its most uncertain direction.
  [[nodiscard]] double sigma_m() const { return position_sigma(xx, xy, yy); }
};

/// Geometry of a robot with two driven wheels, paper equation (5).
struct DifferentialDrive {
  double track_width_m = 0.4;           ///< W, between the wheels
  double centre_ahead_of_axle_m = 0.0;  ///< c, how far the robot's centre O lies ahead of the axle
};

/// T_t_t1 of the centre O when the left and right wheel travelled the given distances. No division by the curvature, so
/// straight motion and turning on the spot need no special case.
Pose2 wheel_displacement(const DifferentialDrive& drive, double left_m, double right_m);

/// Equation (5) as printed: the left wheel as seen from the turning centre (x right, y forward, theta in radians).
/// 0/0 for a left wheel at rest, unbounded for straight motion; kept for comparison.
Pose2 wheel_displacement_literal(const DifferentialDrive& drive, double left_m, double right_m);

}  // namespace gdtslam
