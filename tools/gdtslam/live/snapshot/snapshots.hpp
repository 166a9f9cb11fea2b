// Snapshots of a drive: a thread writes map and path to files every few seconds and on a signal, and shows them to
// viewers. The folder is renamed into place as a whole, so a reader always finds files of one moment.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/runs/drive/laser_shelf.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

struct DriveState {
  OccupancyMap map;
  Trajectory trajectory;  ///< a pose for each scan
};

/// State of a running drive: the occupancy map of its keyframes and the path, with the loops found so far closed. One
/// thread maps and calls take() for each scan, which costs a lock and, for a keyframe, a copy. Another thread calls
/// state(), whose cost is linear in the keyframes since the last call, or in all keyframes if a loop has moved them.
/// Memory: 80 bytes a keyframe; all scans and the keyframes' ranges are on shelves.
class DriveRecord {
 public:
  DriveRecord(const OccupancyConfig& config, const OccupancyBuilder::Limits& limits)
      : config_(config), limits_(limits) {}

  /// Adds the next scan.
  void take(const MappedScan& mapped);
  [[nodiscard]] std::uint64_t scans() const;
  /// Moves the scans taken so far to the shelves, so that they do not fill the memory. Called by the thread that calls
  /// state().
  void take_news();
  /// Returns the state after the scans taken so far. Only one thread may call it. Throws InputError if the map would be
  /// too large.
  DriveState state();

 private:
  struct Scan {
    double stamp_s = 0.0;
    Pose2 T_front_base;
    bool ends_keyframe = false;  // the last scan of an observation that is a keyframe
    bool is_shown = false;       // part of a keyframe that belongs into the map
  };
  struct News {
    Scan scan;
    LaserScan ranges;  // empty unless is_shown
  };

  [[nodiscard]] std::vector<Pose2> keyframe_poses() const;
  void cast(const std::vector<Pose2>& poses);

  OccupancyConfig config_;
  OccupancyBuilder::Limits limits_;
  // Shared by both threads, under the lock:
  mutable std::mutex mutex_;
  std::uint64_t taken_ = 0;
  std::vector<News> news_;
  std::shared_future<ClosedKeyframes> asked_;
  // Used by the caller of state():
  Shelf<Scan> scans_{{}, ByteShelf::kFewBytes};
  std::vector<Pose2> T_front_keyframes_;
  std::vector<std::size_t> shown_;    // number of shown scans up to each scan
  std::vector<Pose2> T_front_shown_;  // poses of these scans
  LaserShelf ranges_{{}};             // ranges of these scans
  std::shared_future<ClosedKeyframes> awaited_;
  ClosedKeyframes closed_;
  std::optional<OccupancyBuilder> map_;
  std::optional<LaserShelf::Reader> to_cast_;
  std::optional<LaserScan> in_hand_;  // next scan of to_cast_, if the map did not accept it
  std::size_t cast_ = 0;              // number of scans cast, at the keyframe poses of `closed_`
};

/// Makes SIGUSR1 request a snapshot instead of ending the process. Call it before any thread starts.
void let_signal_save();

class Snapshots {
 public:
  struct Plan {
    std::string folder;    ///< folder of the run; the files go into its folder `snapshot`
    double every_s = 0.0;  ///< 0: only on the signal
    bool is_quiet = false;
    /// `show` is called once a second while is_watched() is true.
    std::function<bool()> is_watched{};
    std::function<void(const DriveState&)> show{};
  };
  /// `record` must outlive this.
  Snapshots(DriveRecord& record, Plan plan) : record_(record), plan_(std::move(plan)) {}
  Snapshots(const Snapshots&) = delete;
  Snapshots& operator=(const Snapshots&) = delete;
  ~Snapshots() { stop(); }

  /// Starts the thread. Nothing is written before the first scan.
  void start();
  /// Ends the thread, after the snapshot in progress. The folder `snapshot` stays until the finished run replaces it.
  void stop();

 private:
  void work();
  void make(bool is_to_be_saved, bool is_to_be_shown);
  void save(const DriveState& state);
  [[nodiscard]] std::string name() const;

  DriveRecord& record_;
  Plan plan_;
  std::uint64_t saved_ = 0;  // scans in the last snapshot
  std::uint64_t shown_ = 0;
  std::string last_problem_;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace gdtslam
