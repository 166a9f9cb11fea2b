// Looks for loops: the scans around a place, searched in those around an earlier one by the certified search, in the
// window and with the prior that the graph's covariance gives. Frames: places are the middles of groups of keyframes.
// Not thread-safe; has its own workers look ahead where they are given. Cost: about 1 ms a search, 5 ms for each new
// group that is searched in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/loop_verdict.hpp"
#include "engine/mapping/loops/revisits.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// How places are looked for.
struct LoopSearchOptions {
  double query_half_m = 4.0;      ///< path length to each side of a place that is looked for
  double reference_half_m = 9.0;  ///< and of one that it is looked for in
  double resolution_m = 0.1;      ///< cell size of the distance field
  std::size_t points = 300;       ///< points of the query
  double gap_m = 0.03;            ///< to what is proven: no loop is believed to be better than that
  std::uint64_t most_boxes = 50000;
  /// Memory of groups kept to be searched in again, as if all their prepared fields were kept with them: loops depend
  /// on when a group is made anew.
  std::size_t most_bytes = 256U << 20U;
  std::size_t most_prepared_bytes = 28U << 20U;  ///< memory of fields really kept; they are made again alike
  RevisitRules revisits;
  LoopLimits limits;
};

/// Counts of searches and of their results.
struct LoopCounts {
  std::uint64_t searched = 0;
  std::uint64_t found = 0;
  std::uint64_t boxes = 0;
};

class LoopFinder {
 public:
  explicit LoopFinder(const LoopSearchOptions& options);
  ~LoopFinder();
  LoopFinder(const LoopFinder&) = delete;
  LoopFinder& operator=(const LoopFinder&) = delete;

  /// The path has grown, or its keyframes have moved, which forget_bent() is to be told: all of them. They must stay
  /// until the next call, or the end.
  void extend(const KeyframePath& keyframes) { keyframes_ = keyframes; }
  /// The keyframe in the middle of the next group, behind the last one's.
  void add_place(std::size_t keyframe);
  /// The scans around a place are gone: it is neither looked for nor at any more.
  void leave_out(std::size_t place);
  /// The loops of a place to earlier ones that the graph does not have yet, or has switched off. Its nodes are the
  /// places.
  /// The workers share out the earlier ones, of which the `most` likeliest are searched.
  std::vector<Loop> look(const PoseGraph& graph, std::size_t here, std::size_t most, WorkerPool& workers);
  /// Looks at places from `first` until before `end`, one after the other, and gives the loops of each to take_loops(),
  /// which tells whether it has changed the graph with them. Workers look ahead: what they found counts while the graph
  /// is as they saw it. Loops and graph are the same for any number of them.
  using Take = std::function<bool(std::size_t here, const std::vector<Loop>& loops)>;
  void look_at(const PoseGraph& graph, std::size_t first, std::size_t end, WorkerPool& workers, const Take& take_loops);
  /// The keyframes have moved: groups in which they did so relative to each other are made anew.
  void forget_bent();
  [[nodiscard]] const LoopCounts& counts() const { return counts_; }

 private:
  struct Reference;
  struct Fresh;
  struct Found;
  std::vector<Found> look_ahead(const PoseGraph& graph, std::size_t here);
  [[nodiscard]] std::vector<Revisit> wanted_revisits(const PoseGraph& graph, std::size_t here, std::size_t most) const;
  [[nodiscard]] std::vector<bool> left_out_before(std::size_t here) const;
  [[nodiscard]] ScanGroup query_at(std::size_t here) const;
  Found find(const Revisit& revisit, const ScanGroup& query);
  static Matrix3 found_information(const Found& found);
  void search(Reference& reference, const ScanGroup& query, Found& found);
  std::vector<Loop> take(std::vector<Found> all, std::size_t here);
  void take_reference(const Found& found);
  Reference& reference_at(std::size_t place);
  void forget_prepared(std::size_t place);
  void make_room(std::size_t place);

  KeyframePath keyframes_;
  std::vector<std::size_t> places_;
  std::vector<double> path_m_;     // until each place
  std::vector<bool> is_left_out_;  // places that are left out
  LoopSearchOptions options_;
  std::unique_ptr<Backend> backend_;
  std::map<std::size_t, std::unique_ptr<Reference>> references_;
  std::map<std::size_t, std::unique_ptr<Fresh>> fresh_;  // made while looking ahead, of the keyframes as they are
  std::mutex fresh_mutex_;
  std::mutex backend_mutex_;
  std::uint64_t asked_ = 0;  // references, so far
  std::uint64_t made_ = 0;   // number of fields made so far
  LoopCounts counts_;
};

}  // namespace gdtslam
