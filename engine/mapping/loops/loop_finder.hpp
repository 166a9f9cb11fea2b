// Searches for loops: the scans around a place are matched with those around an earlier one by the certified search, in
// the window and with the prior that the graph's covariance gives. Frames: a place is the middle of a group of
// keyframes. Not thread-safe; uses the workers it is given to look ahead. Cost: about 1 ms a search, 5 ms for each new
// group that is searched in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/loop_verdict.hpp"
#include "engine/mapping/loops/revisits.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// Options of the search for loops.
struct LoopSearchOptions {
  double query_half_m = 4.0;      ///< path length to each side of the place in the query
  double reference_half_m = 9.0;  ///< path length to each side of the earlier place
  double resolution_m = 0.1;      ///< cell size of the distance field
  std::size_t points = 300;       ///< points of the query
  double gap_m = 0.03;            ///< proven gap: no loop counts as better than this
  std::uint64_t most_boxes = 50000;
  /// Memory of kept groups, counted as if their prepared fields were kept too, because the loops depend on when a group
  /// is made anew.
  std::size_t most_bytes = 256U << 20U;
  std::size_t most_prepared_bytes = 28U << 20U;  ///< memory of fields that are really kept; a field made again has the
                                                 ///< same bits
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

  /// Takes a path that has grown. If keyframes have moved, call forget_bent() too. All keyframes must stay valid until
  /// the next call, or the end.
  void extend(const KeyframePath& keyframes) { keyframes_ = keyframes; }
  /// Adds a place: the keyframe in the middle of the next group, later than the last one.
  void add_place(std::size_t keyframe);
  /// Leaves a place out of all further searches, because its scans are gone.
  void leave_out(std::size_t place);
  /// Finds loops from a place to earlier ones that the graph lacks or has switched off, except where a search in about
  /// the same window found none. The graph's nodes are the places. The workers share the earlier places; only the
  /// `most` likeliest are searched.
  std::vector<Loop> look(const PoseGraph& graph, std::size_t here, std::size_t most, WorkerPool& workers) {
    return look(graph, GraphCovariance(graph), here, most, workers);
  }
  /// Searches at the places from `first` to before `end`, in order, and gives the loops of each to take_loops(), which
  /// returns true if it changed the graph. Workers look ahead; their results count only while the graph is unchanged.
  /// Loops and graph are the same for any number of workers.
  using Take = std::function<bool(std::size_t here, const std::vector<Loop>& loops)>;
  void look_at(const PoseGraph& graph, std::size_t first, std::size_t end, WorkerPool& workers, const Take& take_loops);
  /// The keyframes have moved: groups whose keyframes moved relative to each other are made anew.
  void forget_bent();
  /// Frees the groups; call after the last search.
  void end();
  [[nodiscard]] const LoopCounts& counts() const { return counts_; }

 private:
  std::vector<Loop> look(const PoseGraph& graph, const GraphCovariance& covariance, std::size_t here, std::size_t most,
                         WorkerPool& workers);
  struct Reference;
  struct Fresh;
  struct Found;
  std::vector<Found> look_ahead(const PoseGraph& graph, const GraphCovariance& covariance, std::size_t here);
  [[nodiscard]] bool was_in_vain(const Revisit& revisit, std::size_t here) const;
  [[nodiscard]] std::vector<Revisit> wanted_revisits(const PoseGraph& graph, const GraphCovariance& covariance,
                                                     std::size_t here, std::size_t most) const;
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
  std::vector<double> path_m_;     // path length up to each place
  std::vector<bool> is_left_out_;  // places that are left out
  LoopSearchOptions options_;
  std::unique_ptr<Backend> backend_;
  std::map<std::size_t, std::unique_ptr<Reference>> references_;
  std::map<std::size_t, std::unique_ptr<Fresh>> fresh_;  // made while looking ahead, from the current keyframes
  std::mutex fresh_mutex_;
  std::mutex backend_mutex_;
  std::uint64_t asked_ = 0;  // number of requests for references so far
  std::uint64_t made_ = 0;   // number of fields made so far
  LoopCounts counts_;
  std::map<std::pair<std::size_t, std::size_t>, Revisit> in_vain_;  // by the two places: the last search without result
};

}  // namespace gdtslam
