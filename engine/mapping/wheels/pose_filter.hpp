// Combines the wheels and a match into one pose of a scan: along a corridor only the wheels measure the motion. The
// match's information comes from the normals of the scan's points. Not thread-safe; linear in the points.
#pragma once

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "engine/mapping/wheels/wheel_noise.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Information of a match about the scan's pose, and the share of a motion for which the match is reliable, along the
/// axes of the scan's shape: by all points, and by surfaces alone.
struct MatchInformation {
  Matrix3 matrix;
  Matrix3 believed = Matrix3::identity();
  Matrix3 held = Matrix3::identity();
};

class PoseFilter {
 public:
  /// Wheels and match combined.
  struct Fused {
    Pose2 T_map_base;
    Matrix3 covariance;
    bool is_possible = true;  ///< both can be right
  };

  /// The robot moved from its last pose to `T_map_predicted`, with this noise.
  void predict(const Pose2& T_map_predicted, const MotionNoise& noise);
  [[nodiscard]] const Pose2& pose() const { return T_map_base_; }
  [[nodiscard]] const Matrix3& covariance() const { return covariance_; }
  /// Uncertainty of the pose relative to the local map: in the least sure direction, and in heading.
  [[nodiscard]] MotionNoise sigma() const;
  /// Combines the prediction with a match of this information.
  [[nodiscard]] Fused fused_with(const Pose2& T_map_matched, const MatchInformation& match) const;
  /// Sets the pose; without this call the prediction stays.
  void take(const Pose2& T_map_base, const Matrix3& covariance);

 private:
  Pose2 T_map_base_;
  Matrix3 covariance_ = Matrix3::diagonal(1.0e-6, 1.0e-6, 1.0e-7);  // tangent's, relative to the local map
};

MatchInformation match_information(const KeptScan& scan);
/// True if two poses lie farther apart than the error of a match of this information.
bool are_apart(const Pose2& T_map_a, const Pose2& T_map_b, const Matrix3& information);

}  // namespace gdtslam
