// The colours that a picture of a cloud gives its points, for who writes the points elsewhere. Thread-safe; O(n).
#pragma once

#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

/// One for each point, by the look's colour, colour map and range. `distances_m` belongs to CloudColour::kDistance.
/// Throws ConfigError as CloudScene does.
std::vector<Colour> point_colours(std::span<const CloudPoint> cloud, const CloudLook& look,
                                  std::span<const float> distances_m = {});

}  // namespace gdtslam
