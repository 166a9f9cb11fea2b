// Closes loops while the mapping runs: a second thread follows the growing path. A loop takes effect a fixed number of
// places later; if the thread is late, the caller waits. So results depend on the keyframes alone, never on time. The
// threads share only the queue of keyframes and the list of results, each under the same lock. One caller. Cost:
// docs/loops.md.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/core/worker_pool.hpp"
#include "engine/mapping/loops/loop_closer.hpp"
#include "gdtslam/mapping/loop_closing.hpp"

namespace gdtslam {

/// Keyframe of the front end: an entry of FrontEndPath.
struct Keyframe {
  KeptScan scan;
  Pose2 T_map_base;
  double path_m = 0.0;  ///< length of the path up to it
  MeasuredSteps steps;
  WheelTravel travel{};
};

struct LiveOptions {
  bool is_beside = true;  ///< else the caller's thread does the work, after the same number of places
  /// Called if no thread can be started; the caller's thread then does the work.
  std::function<void(const std::string&)> warn{};
  unsigned threads = 1;          ///< threads that search beside the mapping, including the one that always runs
  std::string scratch_folder{};  ///< folder in which steps wait for the end
  std::size_t shelf_bytes = ByteShelf::kFewBytes;  ///< memory of the steps
};

class LiveLoops {
 public:
  /// A loop takes effect when this many places have come after the one where it was found.
  static constexpr std::size_t kPlacesLate = 8;

  LiveLoops(const LoopOptions& options, LiveOptions live);
  LiveLoops(const LiveLoops&) = delete;
  LiveLoops& operator=(const LiveLoops&) = delete;
  /// Waits for the current place at most.
  ~LiveLoops() { abandon(); }

  /// Takes the next keyframe. An exception that the thread met at a place is rethrown when its loops would take effect.
  void take(Keyframe keyframe);
  /// Correction from the front end's frame to the map with all loops that have taken effect.
  [[nodiscard]] const Pose2& correction() const { return T_closed_front_; }
  [[nodiscard]] LiveStatistics statistics() const;
  /// Requests the distance field of the keyframes handed over so far; ready when the thread reaches the request.
  std::shared_future<FrozenMap> request_map(const MapperConfig& config);
  /// Requests the poses of the keyframes.
  std::shared_future<ClosedKeyframes> request_keyframes();

  /// Waits until the thread has followed all keyframes, reports the finished share, and ends the thread. Rethrows the
  /// thread's exception and any that progress() throws.
  LoopCloser& end(const std::function<void(double)>& progress);
  /// Ends the thread after the current place. Keyframes it has not reached are in path(), without a search.
  void abandon();
  /// All keyframes handed over. Call after end() or abandon(); after abandon() the oldest steps are missing.
  [[nodiscard]] const FrontEndPath& path() const { return path_; }
  /// Keyframes that have no scan any more (PlacePruning).
  [[nodiscard]] const std::vector<bool>& is_pruned() const { return is_pruned_; }
  /// Takes all scans that are still there from the path.
  std::vector<KeptScan> take_scans() { return path_.scans.take(); }

 private:
  struct MapRequest {
    MapperConfig config;
    std::promise<FrozenMap> promise;
  };
  using KeyframesRequest = std::promise<ClosedKeyframes>;
  /// Measurements of a keyframe, which wait on the shelf for the end.
  struct Measured {
    MeasuredSteps steps;
    WheelTravel travel;
  };
  using Order = std::variant<Keyframe, MapRequest, KeyframesRequest>;

  void start();
  bool start_thread();
  void hand_over(Order order);
  void work();
  void carry_out(Order& order);
  void follow(Keyframe& keyframe);
  void draw_map(MapRequest& request) const;
  void append(Keyframe& keyframe);
  void forget_steps();
  void recall_steps();
  void apply(std::size_t place);
  void join();

  LiveOptions live_;
  // Used by the caller's thread only:
  PlaceCounter counter_;
  Pose2 T_closed_front_;
  LiveStatistics statistics_;
  bool is_started_ = false;
  // Used by the worker thread only, from its start to its end:
  FrontEndPath path_;
  Shelf<Measured> measured_;     // measurements of its keyframes
  std::vector<bool> is_pruned_;  // keyframes without a scan
  LoopCloser closer_;
  std::unique_ptr<WorkerPool> workers_;
  // Shared by both threads, guarded by the mutex:
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  std::deque<Order> orders_;
  std::vector<Pose2> found_;   // corrections, one a place
  double beside_cpu_s_ = 0.0;  // CPU time of the thread
  std::exception_ptr failure_;
  bool is_ending_ = false;     // the thread ends when all orders are carried out
  bool is_abandoned_ = false;  // the thread ends at once
  bool is_over_ = false;       // no thread is left to carry orders out
  std::thread thread_;
};

}  // namespace gdtslam
