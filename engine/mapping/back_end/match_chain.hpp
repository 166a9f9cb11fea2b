// Uncertainty of a keyframe relative to the last place by matches alone, along directions that surfaces constrain
// badly: that of its own match with the surfaces it sees, and of the keyframes that first saw these. If no surface
// stands across the way nothing is known, however sure the wheels are, because wheels count separately. Frame: that of
// each keyframe. Not thread-safe. Cost: linear in a scan's points.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class MatchChain {
 public:
  /// Takes the next keyframe: its pose in the local map, and the part of its scan that lies on `surfaces` (empty if
  /// nothing matched). Returns its covariance (tangent at it) relative to the last place, or for a place relative to
  /// the one before.
  Matrix3 take(const Pose2& T_map_base, const KeptScan& known, const KnownSurfaces& surfaces, bool is_place);

 private:
  struct Since {
    double heading_rad = 0.0;
    Matrix3 covariance;
  };
  [[nodiscard]] Matrix3 of_first_seen(const Pose2& T_map_base, const KeptScan& known,
                                      const KnownSurfaces& surfaces) const;

  std::size_t next_ = 0;   // keyframe
  std::size_t place_ = 0;  // keyframe of the last place
  Matrix3 own_of_place_;   // covariance of its match with earlier keyframes
  double heading_of_place_rad_ = 0.0;
  std::vector<Since> links_;  // links between the keyframes since then
};

}  // namespace gdtslam
