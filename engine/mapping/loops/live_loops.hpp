// Loops closed beside the mapping: a thread of its own follows the path while it grows. What it finds takes effect
// when so many places have come after, and where it is not done by then the caller waits: what is seen of it depends on
// the keyframes alone, never on time. The caller hands keyframes over and shares nothing with the thread but the queue
// of them and the list of what was found, each under the one lock. One caller. Cost: docs/loops.md.
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
  double path_m = 0.0;  ///< travelled until it
  MeasuredSteps steps;
  WheelTravel travel{};
};

struct LiveOptions {
  bool is_beside = true;  ///< else the caller's thread does the same at the same counts
  /// Called where there is no thread to be had; the caller's does it then.
  std::function<void(const std::string&)> warn{};
  unsigned threads = 1;          ///< that look, beside the mapping: the one that there is then anyway, and others
  std::string scratch_folder{};  ///< folder in which steps wait for the end
  std::size_t shelf_bytes = ByteShelf::kFewBytes;  ///< memory of the steps
};

class LiveLoops {
 public:
  /// Places that come after one before what was found there takes effect.
  static constexpr std::size_t kPlacesLate = 8;

  LiveLoops(const LoopOptions& options, LiveOptions live);
  LiveLoops(const LiveLoops&) = delete;
  LiveLoops& operator=(const LiveLoops&) = delete;
  /// Waits for the place at work, at most.
  ~LiveLoops() { abandon(); }

  /// The next keyframe. Rethrows what the thread met at a place when what was found there would take effect.
  void take(Keyframe keyframe);
  /// From the front end's frame to the one with the loops closed that have taken effect.
  [[nodiscard]] const Pose2& correction() const { return T_closed_front_; }
  [[nodiscard]] LiveStatistics statistics() const;
  /// The distance field of the keyframes handed over so far, once the thread has come to it.
  std::shared_future<FrozenMap> request_map(const MapperConfig& config);
  /// Requests the poses of the keyframes.
  std::shared_future<ClosedKeyframes> request_keyframes();

  /// Waits until the keyframes handed over are followed, with the share of them; the thread has ended then. Rethrows
  /// what it met. What progress() throws is passed on.
  LoopCloser& end(const std::function<void(double)>& progress);
  /// Ends the thread after the place at work. Keyframes that it has not come to are in path(), and not looked at.
  void abandon();
  /// All keyframes handed over. Not before end() or abandon(); after the latter without steps from long ago.
  [[nodiscard]] const FrontEndPath& path() const { return path_; }
  /// Keyframes that have no scan any more (PlacePruning).
  [[nodiscard]] const std::vector<bool>& is_pruned() const { return is_pruned_; }
  /// Takes the scans from the path, of those that have one.
  std::vector<KeptScan> take_scans() { return path_.scans.take(); }

 private:
  struct MapRequest {
    MapperConfig config;
    std::promise<FrozenMap> promise;
  };
  using KeyframesRequest = std::promise<ClosedKeyframes>;
  /// Measurements between the place behind it and the end, which no caller has requested yet.
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
  // The caller's:
  PlaceCounter counter_;
  Pose2 T_closed_front_;
  LiveStatistics statistics_;
  bool is_started_ = false;
  // The thread's, from its start to its end:
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
  bool is_ending_ = false;     // when all orders are carried out
  bool is_abandoned_ = false;  // at once
  bool is_over_ = false;       // there is no thread any more that would carry them out
  std::thread thread_;
};

}  // namespace gdtslam
