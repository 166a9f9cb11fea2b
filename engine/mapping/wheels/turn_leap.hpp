// Detects a whole turn in which matches and wheels differ by more than their errors, though no single match leaps:
// along a curved wall each match may slide and turn slightly too far, on the surface the previous one drew. Wheels with
// early or late stamps are off within a turn and right again after it, so the two are compared between straight
// stretches before and after. Not thread-safe, constant time.
#pragma once

#include <optional>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

// A match leaps if it differs from the prediction by more than both errors: one of the two is wrong by the whole
// difference, and the two alone do not show which. Thread-safe, constant time.

/// Tangent from the predicted to the matched pose, if the match leapt. `result` must state the prediction's sigma.
inline std::optional<Tangent2> find_leap(const MatchResult& result) {
  constexpr double kMatchNoise_m = 0.02;  // usual error of a match
  constexpr double kMatchNoise_rad = 0.01;
  constexpr double kLeapChi2 = 25.0;
  const Tangent2 off = log_tangent(between(result.T_map_predicted, result.T_map_base));
  const double chi2 = (square(off[0]) + square(off[1])) / (square(result.predicted_sigma_m) + square(kMatchNoise_m)) +
                      square(off[2]) / (square(result.predicted_sigma_rad) + square(kMatchNoise_rad));
  return chi2 > kLeapChi2 ? std::optional(off) : std::nullopt;
}

class TurnLeap {
 public:
  /// Takes one scan. After a turn that leapt, returns how much farther the matches turned than the wheels. `result`
  /// must state the sigmas of its step.
  std::optional<double> take(const MatchResult& result);

 private:
  [[nodiscard]] bool is_straight(const MatchResult& result, double off_rad);

  double off_rad_ = 0.0;  // excess of the matches' turn over the wheels' since the turn began
  double variance_rad2_ = 0.0;
  // Since the headings of both last changed:
  double straight_since_s_ = 0.0;
  double by_match_rad_ = 0.0;
  double by_wheels_rad_ = 0.0;
};

}  // namespace gdtslam
