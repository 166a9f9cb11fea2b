// Adjusts all keyframes together: each is matched with its neighbours in time and in space, points to lines [Lu1997],
// with the front end's relations over short stretches of the path. Gauss-Newton with a gate that narrows; a pair that
// hardly moves keeps its equations. The same bits for any number of threads. Cost: some ten iterations over about
// fifteen pairs a keyframe, nearly linear in the keyframes; 24 bytes a point and 250 a pair.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/adjust/line_pairs.hpp"
#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

/// Two keyframes that see the same walls, the earlier one first.
using KeyframePair = std::pair<std::size_t, std::size_t>;

/// Pairs each keyframe with those at these distances back in time, and with the nearest earlier ones: at most
/// `most_near` within a distance.
struct PairRules {
  std::vector<std::size_t> back = {1, 2, 3, 5, 8, 12, 18, 26};
  std::size_t most_near = 6;
  double near_m = 4.0;
};

/// Chooses the pairs by the current poses, in the order of the later keyframe.
std::vector<KeyframePair> find_pairs(const std::vector<Pose2>& poses, const PairRules& rules = {});

struct JointOptions {
  int iterations = 10;     ///< at most; ends earlier if,
  double still_m = 0.002;  ///< with the last gate, no keyframe moves farther than this
  double first_gate_m = 0.15;
  double last_gate_m = 0.1;
  double narrowing = 0.6;
  double point_noise_m = 0.02;
  double independent = 0.2;  ///< share of independent points
  std::size_t points = 90;   ///< taken from a scan for each pair
};

/// Result of an adjustment.
struct JointResult {
  double rms_m = 0.0;           ///< RMS distance of the points from their lines, at the last gate
  double largest_step_m = 0.0;  ///< largest change of a pose in the last iteration
  std::size_t pairs = 0;
};

class JointAdjustment {
 public:
  /// `scans` must outlive this, one a pose. `held` are further relations, with their information.
  JointAdjustment(const std::vector<LineScan>& scans, std::vector<PoseRelation> held, const JointOptions& options);

  /// Called after each iteration with the finished share.
  using Progress = std::function<void(double)>;
  /// Adjusts `poses`; the workers match the pairs, or the device if there is one.
  JointResult run(
      std::vector<Pose2>& poses, WorkerPool& workers, const Progress& progress = [](double) {},
      const BatchDevice& device = {}) const;

 private:
  class Systems;
  struct OneWay;
  struct Built;
  double take_step(double gate_m, Systems& systems, std::vector<Pose2>& poses, WorkerPool& workers, LinePairs& lines,
                   JointResult& result) const;
  LineEquations lay_pairs(const LineGate& gate, Systems& systems, const std::vector<Pose2>& poses, WorkerPool& workers,
                          LinePairs& lines) const;
  [[nodiscard]] OneWay one_way(const LinePair& way, double gate_m, Built& built) const;

  const std::vector<LineScan>& scans_;
  std::vector<PoseRelation> held_;
  JointOptions options_;
};

}  // namespace gdtslam
