// Motion of a robot with two driven wheels between two instants, paper equation (5).
// Frame of the result: REP-103 (x forward, y left) of the robot at the first instant. Thread-safe, constant time.
#pragma once

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Geometry of the drive.
struct DifferentialDrive {
  double track_width_m = 0.4;           ///< W, between the wheels
  double centre_ahead_of_axle_m = 0.0;  ///< c, how far the robot's centre O lies ahead of the axle
};

/// T_t_t1 of the centre O when the left and right wheel travelled the given distances. No division by the curvature, so
/// straight motion and turning on the spot need no special case.
Pose2 wheel_displacement(const DifferentialDrive& drive, double left_m, double right_m);

/// Equation (5) as printed: the left wheel as seen from the turning centre (x right, y forward, theta in radians).
/// 0/0 for a left wheel at rest, unbounded when straight; kept to be compared with.
Pose2 wheel_displacement_literal(const DifferentialDrive& drive, double left_m, double right_m);

}  // namespace gdtslam
