// How good a way of measuring the path really is: what a chain of its steps says of where loops tie the path to itself,
// against what the loops say. Two sources of one step may agree because one was taken for the other, so their
// difference tells nothing; loops know neither. The factor is that of the largest likelihood, with Student's t for the
// residuals of a loop, some of which are wrong [Lange1989]. Thread-safe. Cost: linear in steps and loops.
#pragma once

#include <cstddef>
#include <span>

#include "pose_graph.hpp"

namespace gdtslam {

inline constexpr double kLeastVarianceFactor = 0.01;
inline constexpr double kMostVarianceFactor = 110.0;

/// By how much variances are larger than they were said to be: above 1 a measurement is worse than it claims. Matches
/// have one factor for both: over a path the errors of heading make most of those of position, and loops cannot tell
/// them apart.
struct VarianceFactor {
  double variance = 1.0;
  double turn_variance = variance;  ///< factor of the heading's variance
  std::size_t closures = 0;         ///< loops or steps that it comes from
};

/// Estimates the factor of a chain, whose relation i goes from node i to node i + 1, by the loops that are on. Between
/// 1/100 and 100, near 1 if the loops say little, and 1 if there are fewer than four.
VarianceFactor variance_factor(std::span<const PoseRelation> chain, std::span<const Loop> loops);

/// The relation with a covariance so much larger.
PoseRelation rescaled(const PoseRelation& relation, const VarianceFactor& factor);

}  // namespace gdtslam
