// Before and after of a registration: both clouds from above and from the side, at the start and at the result, all at
// one scale. Points of both clouds in one place are dark. Thread-safe; O(points).
#pragma once

#include <span>
#include <string>

#include "engine/cloud/cloud_alignment.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

/// `T_a_b_start` is the pose of `found.before`. Strays far outside of both clouds are cut off.
Canvas draw_alignment(const std::string& title, std::span<const CloudPoint> a, std::span<const CloudPoint> b,
                      const Pose3& T_a_b_start, const Alignment& found);

}  // namespace gdtslam
