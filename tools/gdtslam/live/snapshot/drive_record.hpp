// What is known of a drive while it goes on: the occupancy map of its keyframes and the path, with the loops closed
// that have been found. One thread maps and hands over each scan, which costs it a lock and of a keyframe a copy;
// another one asks for the state. Cost of that: the keyframes since the last time, all of them where a loop has moved
// them. Memory: 80 bytes a keyframe; all scans and the keyframes' ranges are on shelves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/runs/mapping/laser_shelf.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

struct DriveState {
  OccupancyMap map;
  Trajectory trajectory;  ///< a pose for each scan
};

class DriveRecord {
 public:
  DriveRecord(const OccupancyConfig& config, const OccupancyBuilder::Limits& limits)
      : config_(config), limits_(limits) {}

  /// The next scan.
  void take(const MappedScan& mapped);
  [[nodiscard]] std::uint64_t scans() const;
  /// Takes over what was handed over by now, so that it does not wait in memory; for the thread that asks for the
  /// state.
  void take_news();
  /// As of the scans handed over by now, for one thread. Throws InputError where the map would be too large.
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
    LaserScan ranges;  // of a scan that is shown
  };

  [[nodiscard]] std::vector<Pose2> keyframe_poses() const;
  void cast(const std::vector<Pose2>& poses);

  OccupancyConfig config_;
  OccupancyBuilder::Limits limits_;
  // Of both, under the lock:
  mutable std::mutex mutex_;
  std::uint64_t taken_ = 0;
  std::vector<News> news_;
  std::shared_future<ClosedKeyframes> asked_;
  // Of whoever asks:
  Shelf<Scan> scans_{{}, ByteShelf::kFewBytes};
  std::vector<Pose2> T_front_keyframes_;
  std::vector<std::size_t> shown_;    // scans that are shown, up to each of them
  std::vector<Pose2> T_front_shown_;  // of these scans
  LaserShelf ranges_{{}};             // likewise
  std::shared_future<ClosedKeyframes> awaited_;
  ClosedKeyframes closed_;
  std::optional<OccupancyBuilder> map_;
  std::optional<LaserShelf::Reader> to_cast_;
  std::optional<LaserScan> in_hand_;  // the next one of it, where the map would not take it
  std::size_t cast_ = 0;              // scans, from where `closed_` has their keyframes
};

}  // namespace gdtslam
