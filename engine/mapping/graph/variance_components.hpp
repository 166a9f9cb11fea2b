// Estimates how good a way of measuring the path is, by comparing a chain of its steps with the loops that tie the path
// to itself. Two sources of one step may agree because one was derived from the other, so their difference shows
// nothing; loops depend on neither. The factor has the largest likelihood, with Student's t for the residuals of a
// loop, some of which are wrong [Lange1989]. Thread-safe. Cost: linear in steps and loops.
#pragma once

#include <cstddef>
#include <span>

#include "pose_graph.hpp"

namespace gdtslam {

inline constexpr double kLeastVarianceFactor = 0.01;
inline constexpr double kMostVarianceFactor = 110.0;

/// Ratio of actual to stated variances: above 1 a measurement is worse than stated. Matches have one factor for both:
/// over a path the errors of heading cause most of those of position, and loops cannot separate them.
struct VarianceFactor {
  double variance = 1.0;
  double turn_variance = variance;  ///< factor of the heading's variance
  std::size_t closures = 0;         ///< number of loops or steps it was estimated from
};

/// Estimates the factor of a chain, whose relation i goes from node i to node i + 1, by the active loops. The factor is
/// between 1/100 and 100, near 1 if the loops have little information, and 1 if there are fewer than four.
VarianceFactor variance_factor(std::span<const PoseRelation> chain, std::span<const Loop> loops);

/// The relation with its covariance multiplied by the factor.
PoseRelation rescaled(const PoseRelation& relation, const VarianceFactor& factor);

}  // namespace gdtslam
