// Closes the loops of a path with a graph of places along it. While the path grows, loops are searched in its order,
// each in the graph with all earlier loops. At the end, rounds over all places follow, and the keyframes between the
// places are moved with them. Frame: that of the path's first keyframe, which does not move. Not thread-safe. Cost:
// some milliseconds a place (docs/loops.md).
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/loop_finder.hpp"
#include "engine/mapping/loops/measured_path.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

// Moves keyframes with the places of a graph. Thread-safe; linear in the keyframes.

/// Writes the poses of the keyframes from the first place on. Between two places the path keeps its shape, and the
/// graph's correction of its end is spread over it. `places` are ascending indices of keyframes; only places that have
/// a pose in `of_places` count. `shape` and `poses` have one entry a keyframe.
void carry_keyframes_between(std::span<const std::size_t> places, std::span<const Pose2> of_places,
                             std::span<const Pose2> shape, std::span<Pose2> poses);

// Selects the places whose scans are no longer needed. If a robot drives the same way all day, the first passes carry
// as much information as all of them [Kurz2021]. So memory and the searched part of the graph grow with the area, not
// with the hours. Not thread-safe. Cost of a call: linear in the places kept and in the loops.

/// Rules that decide whether a place has been passed often enough.
struct PruningRules {
  std::size_t most_passes = 8;    ///< number of places beside it that keep their scans
  double near_m = 2.0;            ///< greatest distance of such a place: half the spacing along a path
  double near_rad = 0.785;        ///< greatest difference in heading, because scans see little behind them
  std::size_t places_later = 16;  ///< delay of the decision; until then the stretches around it are searched
};

class PlacePruning {
 public:
  explicit PlacePruning(const PruningRules& rules) : rules_(rules) {}

  /// Call it once for each place, in order, after the search at the last node of the graph. Returns the place whose
  /// scans are dropped: one with enough others beside it and a loop that ties it to them. If the surroundings have
  /// changed, no loop is found, and the scans stay.
  std::optional<std::size_t> next(const PoseGraph& graph);
  /// True if enough places beside this one were decided on and keep their scans.
  [[nodiscard]] bool is_crowded(const PoseGraph& graph, std::size_t place) const {
    return kept_beside(graph, place) >= rules_.most_passes;
  }

 private:
  [[nodiscard]] std::size_t kept_beside(const PoseGraph& graph, std::size_t place) const;

  PruningRules rules_;
  std::vector<std::size_t> kept_;  // places that were decided on and keep their scans
};

/// Spacing of the places and rounds of the search.
struct LoopOptions {
  double place_every_m = 4.0;
  std::size_t most_between = 60;  ///< most keyframes between two places, for a robot that turns on the spot
  int rounds = 2;                 ///< over all places, after the search in the order of the path
  LoopSearchOptions search;
  PruningRules pruning;
};

/// Decides for each keyframe, as it comes, whether it is a place.
class PlaceCounter {
 public:
  explicit PlaceCounter(const LoopOptions& options) : options_(options) {}
  /// Takes the next keyframe. `path_m` is the length of the path up to it.
  bool is_place(double path_m);
  /// Number of places so far.
  [[nodiscard]] std::size_t places() const { return places_; }

 private:
  LoopOptions options_;
  std::size_t places_ = 0;
  std::size_t since_last_ = 0;  // keyframes
  double last_m_ = 0.0;
};

class LoopCloser {
 public:
  /// Loops of a place are searched when this many places have come after it, because only then all scans around it
  /// exist. The delay is a count, so that loops and graph have the same bytes at any speed.
  static constexpr std::size_t kPlacesAround = 2;

  /// Called with the share of the places searched in this round, and the round.
  using Progress = std::function<void(double, int)>;

  /// `path` may grow; it must outlive this.
  LoopCloser(const FrontEndPath& path, const LoopOptions& options);

  /// Takes the new keyframes of the path and searches at the places that are due.
  void follow(const Progress& progress, WorkerPool& workers);
  /// Call it once, when the path is complete. Follows the path to its end, then makes the rounds, in which the workers
  /// search ahead.
  void run(const Progress& progress, WorkerPool& workers);

  /// Poses of the keyframes with their loops closed; after run().
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  /// The graph; its nodes are the places searched so far.
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  /// Poses of the keyframes by the current graph.
  [[nodiscard]] std::vector<Pose2> carried_keyframes() const;
  /// Correction from front-end poses near the last place to poses in the graph, multiplied from the left. It changes
  /// only with loops.
  [[nodiscard]] const Pose2& correction() const { return T_closed_front_; }
  [[nodiscard]] const std::vector<std::size_t>& places() const { return measured_.places(); }
  /// The measured path, each source weighted by its reliability after the loops are closed.
  [[nodiscard]] const MeasuredPath& measured() const { return measured_; }
  [[nodiscard]] const LoopCounts& counts() const { return finder_.counts(); }
  /// Returns the keyframes pruned since the last call, whose scans are no longer used.
  std::vector<std::size_t> take_pruned() { return std::exchange(pruned_, {}); }

 private:
  bool take_loops(const std::vector<Loop>& loops);
  void take_keyframe();
  void follow_place(std::size_t here, WorkerPool& workers);
  void prune();
  void go_round(const Progress& progress, int round, WorkerPool& workers);
  void weigh_sources();
  void carry_keyframes();

  const FrontEndPath& path_;
  LoopOptions options_;
  PlaceCounter counter_;
  std::size_t known_ = 0;     // keyframes that were taken
  std::vector<Pose2> poses_;  // poses of all keyframes, from the end on
  MeasuredPath measured_;
  std::deque<std::pair<PoseRelation, WheelRelation>> coming_;  // relations to the places that were not searched yet
  PoseGraph graph_;
  LoopFinder finder_;
  PlacePruning pruning_;
  std::vector<std::size_t> pruned_;  // keyframes, since they were taken
  int closed_ = 0;                   // places with loops
  Pose2 T_closed_front_;
};

}  // namespace gdtslam
