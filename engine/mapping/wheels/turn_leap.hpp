// A whole turn in which matches and wheels come apart by more than both can be off, though no single match leaps: along
// a curved wall each match may slide and turn a little too far, on what the one before it drew. Wheels that are told
// early or late are off within a turn and right again behind it, so that the two are compared where the robot went
// straight on before and after. Not thread-safe, constant time.
#pragma once

#include <optional>

#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

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
