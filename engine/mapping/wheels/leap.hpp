// A match leaps that is farther from what was predicted than both can be: one of the two is wrong by all of it, and
// which one the two alone do not say. Thread-safe, constant time.
#pragma once

#include <optional>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// Tangent from the predicted to the matched pose, where the match leapt. `result` must state the prediction's sigma.
inline std::optional<Tangent2> find_leap(const MatchResult& result) {
  constexpr double kMatchNoise_m = 0.02;  // how far a match is off at most times
  constexpr double kMatchNoise_rad = 0.01;
  constexpr double kLeapChi2 = 25.0;
  const Tangent2 off = log_tangent(between(result.T_map_predicted, result.T_map_base));
  const double chi2 = (square(off[0]) + square(off[1])) / (square(result.predicted_sigma_m) + square(kMatchNoise_m)) +
                      square(off[2]) / (square(result.predicted_sigma_rad) + square(kMatchNoise_rad));
  return chi2 > kLeapChi2 ? std::optional(off) : std::nullopt;
}

}  // namespace gdtslam
