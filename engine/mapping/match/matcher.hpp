// What finds the pose of a scan in the map. A matcher that works on a device sets it to work in start() and waits for
// it in finish(), so that the caller can prepare the next scan meanwhile; one that works on the host does all in
// finish(). Frame: map. Not thread-safe.
#pragma once

#include <span>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/mapping/match.hpp"
#include "motion_model.hpp"

namespace gdtslam {

class Matcher {
 public:
  Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;
  virtual ~Matcher() = default;

  /// Begins with the points (cells, robot frame; at least one, at most kMostPoints; they must live until finish()) near
  /// the prediction. `search` asks for a window even when a descent from the prediction raises no suspicion.
  virtual void start(std::span<const PointCells> points, const Prediction& prediction, bool search) = 0;
  /// Best pose of the points, with its evidence.
  virtual MatchResult finish() = 0;

  MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search) {
    start(points, prediction, search);
    return finish();
  }

  /// More terms of 16 bits could overflow the sums of a verdict.
  static constexpr std::size_t kMostPoints = 65535;
};

}  // namespace gdtslam
