// How sure matches alone are of where a keyframe lies beside the last place, along what surfaces do not hold well: as
// sure as its own match with the surfaces that it sees, and as the keyframes that were the first to see these. Where
// none stands across the way nothing is known, however sure wheels are of it, which are counted for themselves. Frame:
// that of each keyframe. Not thread-safe. Cost: linear in a scan's points.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class MatchChain {
 public:
  /// The next keyframe, where it lies in the local map and what of it lies on surfaces that this knows, none where
  /// nothing matched. Returns the covariance (tangent at it) beside the last place, or for a place beside the one
  /// before.
  Matrix3 take(const Pose2& T_map_base, const KeptScan& known, const KnownSurfaces& surfaces, bool is_place);

 private:
  struct Since {
    double heading_rad = 0.0;
    Matrix3 covariance;
  };
  [[nodiscard]] Matrix3 of_first_seen(const Pose2& T_map_base, const KeptScan& known,
                                      const KnownSurfaces& surfaces) const;

  std::size_t next_ = 0;   // keyframe
  std::size_t place_ = 0;  // the last one, its keyframe
  Matrix3 own_of_place_;   // covariance of its match with earlier keyframes
  double heading_of_place_rad_ = 0.0;
  std::vector<Since> links_;  // links between the keyframes since
};

}  // namespace gdtslam
