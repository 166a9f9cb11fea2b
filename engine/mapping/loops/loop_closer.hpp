// Closes the loops of a path: a graph of places along it, loops looked for in the order of the path, each in a graph
// that has those before, then in rounds over all places, and the keyframes between the places carried along. Frame:
// that of the path's first keyframe, which stays. Not thread-safe. Cost: some milliseconds a place (docs/loops.md).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/loop_finder.hpp"
#include "engine/mapping/loops/measured_path.hpp"

namespace gdtslam {

/// How the places lie and how often they are looked at.
struct LoopOptions {
  double place_every_m = 4.0;
  std::size_t most_between = 60;  ///< keyframes, of a robot that turns on the spot
  int rounds = 2;                 ///< over all places, after that in the order of the path
  LoopSearchOptions search;
};

class LoopCloser {
 public:
  /// Called with the share of the places that were looked at in this round, and the round.
  using Progress = std::function<void(double, int)>;

  /// `path` must outlive this.
  LoopCloser(const FrontEndPath& path, const LoopOptions& options);

  void run(const Progress& progress);

  /// Of the keyframes, loops closed.
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  /// Its nodes are the places.
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  [[nodiscard]] const std::vector<std::size_t>& places() const { return measured_.places(); }
  /// The path as far as each of its sources is believed now that loops are closed.
  [[nodiscard]] const MeasuredPath& measured() const { return measured_; }
  [[nodiscard]] const LoopCounts& counts() const { return finder_.counts(); }

 private:
  bool take_loops(PoseGraph& graph, std::size_t here);
  void follow_the_path(const Progress& progress);
  void go_round(const Progress& progress, int round);
  void weigh_sources();
  void carry_keyframes();

  const FrontEndPath& path_;
  LoopOptions options_;
  std::vector<Pose2> poses_;
  MeasuredPath measured_;
  PoseGraph graph_;
  LoopFinder finder_;
};

}  // namespace gdtslam
