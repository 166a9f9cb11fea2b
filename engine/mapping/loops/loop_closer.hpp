// Closes the loops of a path: a graph of places along it, loops looked for in the order of the path, each in a graph
// that has those before, while the path grows; then in rounds over all places, and the keyframes between the places
// carried along. Frame: that of the path's first keyframe, which stays. Not thread-safe. Cost: some milliseconds a
// place (docs/loops.md).
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

// Keyframes that follow the places of a graph. Thread-safe; linear in the keyframes.

/// Writes the poses of the keyframes from the first place on: between two places the path keeps its shape, and what the
/// graph moved its end by is spread over it. `places` are keyframes, ascending, of which those that have a pose in
/// `of_places` count; shape and poses have one entry a keyframe.
void carry_keyframes_between(std::span<const std::size_t> places, std::span<const Pose2> of_places,
                             std::span<const Pose2> shape, std::span<Pose2> poses);

// Which places of a path still need the scans around them: where a robot goes the same way again and again all day, the
// first passes tell as much as all of them [Kurz2021]. So memory, and the part of the graph that others are tied to,
// grow with the area and not with the hours. Not thread-safe. Cost: linear in the places kept and in the loops, each
// time.

/// When there are enough passes of a place.
struct PruningRules {
  std::size_t most_passes = 8;    ///< places beside it that keep their scans
  double near_m = 2.0;            ///< half of what is between two places along a path
  double near_rad = 0.785;        ///< in the same direction: scans see little behind them
  std::size_t places_later = 16;  ///< after which it is decided: until then stretches around it are looked at
};

class PlacePruning {
 public:
  explicit PlacePruning(const PruningRules& rules) : rules_(rules) {}

  /// To be called once a place, in their order, when the last node of the graph was looked at. The place whose scans
  /// go: one that enough others lie beside, and that a loop ties to them. Where all looks otherwise than it did before
  /// no loop is found, and the scans stay.
  std::optional<std::size_t> next(const PoseGraph& graph);
  /// Whether enough others lie beside a place, of those that were decided about and keep their scans.
  [[nodiscard]] bool is_crowded(const PoseGraph& graph, std::size_t place) const {
    return kept_beside(graph, place) >= rules_.most_passes;
  }

 private:
  [[nodiscard]] std::size_t kept_beside(const PoseGraph& graph, std::size_t place) const;

  PruningRules rules_;
  std::vector<std::size_t> kept_;  // kept ones among the places that were decided about
};

/// How the places lie and how often they are looked at.
struct LoopOptions {
  double place_every_m = 4.0;
  std::size_t most_between = 60;  ///< keyframes, of a robot that turns on the spot
  int rounds = 2;                 ///< over all places, after that in the order of the path
  LoopSearchOptions search;
  PruningRules pruning;
};

/// Tells which keyframes are places as they come.
class PlaceCounter {
 public:
  explicit PlaceCounter(const LoopOptions& options) : options_(options) {}
  /// The next keyframe and the path until it, metres.
  bool is_place(double path_m);
  /// So far.
  [[nodiscard]] std::size_t places() const { return places_; }

 private:
  LoopOptions options_;
  std::size_t places_ = 0;
  std::size_t since_last_ = 0;  // keyframes
  double last_m_ = 0.0;
};

class LoopCloser {
 public:
  /// A place is looked at when so many others have come after it: the scans around it are there then. Fixed by counts,
  /// so that loops and graph are the same bytes however the keyframes came.
  static constexpr std::size_t kPlacesAround = 2;

  /// Called with the share of the places that were looked at in this round, and the round.
  using Progress = std::function<void(double, int)>;

  /// `path` may grow; it must outlive this.
  LoopCloser(const FrontEndPath& path, const LoopOptions& options);

  /// Takes the keyframes that the path has gained, and looks at the places that are due.
  void follow(const Progress& progress, WorkerPool& workers);
  /// To be called once, when the path is whole: follows it to its end, then goes round, where the workers look ahead.
  void run(const Progress& progress, WorkerPool& workers);

  /// Poses of the keyframes with their loops closed; after run().
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  /// Its nodes are the places, as far as they were looked at.
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  /// Poses of the keyframes by the graph as it is.
  [[nodiscard]] std::vector<Pose2> carried_keyframes() const;
  /// Correction that turns poses of the front end near the last place into those of the graph, multiplied from the
  /// left; changes with loops only.
  [[nodiscard]] const Pose2& correction() const { return T_closed_front_; }
  [[nodiscard]] const std::vector<std::size_t>& places() const { return measured_.places(); }
  /// The path as far as each of its sources is believed now that loops are closed.
  [[nodiscard]] const MeasuredPath& measured() const { return measured_; }
  [[nodiscard]] const LoopCounts& counts() const { return finder_.counts(); }
  /// The keyframes whose scans nothing looks at any more, since the last call.
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
  std::deque<std::pair<PoseRelation, WheelRelation>> coming_;  // to the places that were not looked at yet
  PoseGraph graph_;
  LoopFinder finder_;
  PlacePruning pruning_;
  std::vector<std::size_t> pruned_;  // keyframes, since they were taken
  int closed_ = 0;                   // places with loops
  Pose2 T_closed_front_;
};

}  // namespace gdtslam
