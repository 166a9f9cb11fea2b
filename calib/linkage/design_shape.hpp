// Shapes of crank-rockers from their dead points [Norton2012]: in both of them crank and coupler are in line, so the
// triangle of the crank's pivot and the rocker's two outermost ends has the sides coupler + crank and coupler - crank
// and, between these, the angle by which the strokes differ. Lengths in cranks, angles in radians. Thread-safe and
// deterministic.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// The place at which the rocker of a crank-rocker turns back, with crank and coupler stretched or folded over each
/// other.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched);

struct ShapeLimits {
  double swing_rad = 0.0;
  /// The slow stroke takes pi + imbalance of the turn, 0 to pi; nothing: any.
  std::optional<double> imbalance_rad;
  double longest = 0.0;  ///< bar
};
double imbalance_of_time_ratio(double time_ratio);

/// The shape of the best least transmission angle; nothing where no crank-rocker keeps to the limits. Some milliseconds
/// with a given imbalance, about a hundred with a free one.
std::optional<FourBar> best_shape(const ShapeLimits& limits);

/// Shapes that keep to the limits and whose transmission angle stays above `least_transmission_rad`: those of an even
/// grid over imbalance and inverse coupler, and of a finer one where the first has some and about `best`, which is one.
std::vector<FourBar> shapes_above(const ShapeLimits& limits, double least_transmission_rad, const FourBar& best);

}  // namespace gdtslam::calib
