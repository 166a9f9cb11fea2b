// Point-to-plane registration [ChenMedioni1992] of one cloud onto another, as a check of sweeps against each other.
#pragma once

#include <cstdint>
#include <span>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

struct RegistrationOptions {
  double max_distance_m = 0.3;      ///< largest distance of a pair, at the start; shrinks
  std::uint32_t max_points = 4000;  ///< points taken of the moving cloud, spread evenly
  std::uint32_t neighbours = 12;    ///< for a normal
  double cell_m = 0.0;              ///< both clouds are thinned to the means of cubes of this edge; 0 keeps all points
  std::uint32_t max_iterations = 30;
  Pose3 start{};           ///< T_target_source to begin from
  double robust_m = 0.0;   ///< pairs this far apart count a quarter [GemanMcClure1985]; 0: all count alike
  bool is_planar = false;  ///< moves in x, y and yaw only
};
struct RegistrationResult {
  Pose3 T_target_source;
  Matrix6 information = Matrix6::Zero();
  std::uint32_t iterations = 0;
  std::uint32_t pairs = 0;
  double rms_before_m = 0.0;  ///< point-to-plane, of the pairs at the identity
  double rms_m = 0.0;
  /// Ratio of the smallest to the largest singular value of the information, with turns counted at the points' mean
  /// distance from their centre: near 0 a direction is not determined.
  double weakest_share = 0.0;
  Tangent3 weakest = Tangent3::Zero();  ///< that direction, a unit vector of the same scale
  Point3 centre = Point3::Zero();       ///< turns of the information are about this point of the target's frame
  bool converged = false;
};
/// The means of the points in cubes of that edge, so that neighbours lie around a point and not along one scan.
Cloud means_of_cubes(std::span<const CloudPoint> cloud, double cell_m);
RegistrationResult register_clouds(std::span<const CloudPoint> source, std::span<const CloudPoint> target,
                                   const RegistrationOptions& options);

}  // namespace gdtslam
