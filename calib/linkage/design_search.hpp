// The shape of the best least transmission angle among those that design_shape.hpp gives. Deterministic; a search takes
// some milliseconds with a given imbalance and about a hundred with a free one. Thread-safe.
#pragma once

#include <optional>

#include "design_shape.hpp"

namespace gdtslam::calib {

struct ShapeLimits {
  double swing_rad = 0.0;
  std::optional<double> imbalance_rad;  ///< nothing: any
  double longest = 0.0;                 ///< bar, in cranks
};

/// Nothing where no crank-rocker keeps to the limits.
std::optional<FourBar> best_shape(const ShapeLimits& limits);

}  // namespace gdtslam::calib
