// From a map's frame to that of the truth: the rigid alignment of the estimated to the true trajectory, which moves a
// cloud as a whole. Heights need none: both frames have the floor's. Thread-safe.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

struct CloudFrame {
  Pose2 T_truth_map;
  std::optional<ReferenceReport> trajectory{};  ///< of the alignment; nothing where the frames are said to agree

  [[nodiscard]] Eigen::Vector3d in_truth(const CloudPoint& point) const {
    const Point2 place_m = T_truth_map * Point2(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    return {place_m.x(), place_m.y(), static_cast<double>(point.z_m)};
  }
};

}  // namespace gdtslam
