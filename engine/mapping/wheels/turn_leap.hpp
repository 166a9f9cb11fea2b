// A whole turn in which matches and wheels come apart by more than both can be off, though no single match leaps: along
// a curved wall each match may slide and turn a little too far, on what the one before it drew. Wheels that are told
// early or late are off within a turn and right again behind it, so that the two are compared where the robot went
// straight on before and after. Not thread-safe, constant time.
#pragma once

#include <optional>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

// A match leaps that is farther from what was predicted than both can be: one of the two is wrong by all of it, and
// which one the two alone do not say. Thread-safe, constant time.

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

class TurnLeap {
 public:
  /// One scan on. Behind a turn that leapt: by how much it is farther in the matches than by the wheels. `result` must
  /// state the sigmas of its step.
  std::optional<double> take(const MatchResult& result);

 private:
  [[nodiscard]] bool is_straight(const MatchResult& result, double off_rad);

  double off_rad_ = 0.0;  // since the turn began: of the matches beyond the wheels
  double variance_rad2_ = 0.0;
  // Since the headings of both last changed.
  double straight_since_s_ = 0.0;
  double by_match_rad_ = 0.0;
  double by_wheels_rad_ = 0.0;
};

}  // namespace gdtslam
