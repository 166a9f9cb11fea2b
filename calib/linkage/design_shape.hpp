// Shapes of crank-rockers from their dead points [Norton2012], where crank and coupler are in line. The triangle of the
// crank's pivot and the rocker's two outermost ends has the sides coupler + crank and coupler - crank; the angle
// between them is the difference of the strokes. Lengths in cranks, angles in radians. Thread-safe and deterministic.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// The dead point of a crank-rocker with crank and coupler stretched or folded.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched);

struct ShapeLimits {
  double swing_rad = 0.0;
  /// The slow stroke takes pi + imbalance of the turn, 0 to pi; empty: any.
  std::optional<double> imbalance_rad;
  double longest = 0.0;  ///< longest bar
};
double imbalance_of_time_ratio(double time_ratio);

/// The shape with the best least transmission angle; empty if no crank-rocker is within the limits. Some milliseconds
/// with a given imbalance, about a hundred with a free one.
std::optional<FourBar> best_shape(const ShapeLimits& limits);

/// Shapes within the limits whose transmission angle stays above `least_transmission_rad`. They come from an even grid
/// over imbalance and inverse coupler, and a finer one over its feasible part and about `best`, which is one of them.
std::vector<FourBar> shapes_above(const ShapeLimits& limits, double least_transmission_rad, const FourBar& best);

}  // namespace gdtslam::calib
