// The fit of a plane where points on one line are an expected outcome. O(n); thread-safe.
#pragma once

#include <optional>

#include "gdtslam/cloud/plane.hpp"

namespace gdtslam {

/// fit_plane(); nothing for fewer than three points and for points on one line as far as floats can tell.
std::optional<PlanePatch> fitted_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points);

}  // namespace gdtslam
