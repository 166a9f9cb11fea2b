// A robot followed by scans and wheels in a map that stays as it is, from a start that is found by itself; where
// nothing matches any more it is looked for in the whole map, as after somebody has carried it away. Frame: the map's,
// metres and radians. One object belongs to one thread. Cost of a scan: that of a match; of a search some tenths of a
// second.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/mapping/map_tracker.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "run.hpp"

namespace gdtslam {

/// How the pose of a scan is known.
enum class Whereabouts : std::uint8_t {
  kUnknown,    ///< not at all: not found yet, or lost
  kFound,      ///< by a search of the whole map, where no other place fits as well
  kTracked,    ///< by a match near where it should be that is a good fit, as the localizer has it
  kPredicted,  ///< by the wheels and by matches that are none, since the last one that was
};

struct TrackedPose {
  Whereabouts whereabouts = Whereabouts::kUnknown;
  Pose2 T_map_base;              ///< nothing where it is unknown
  double explained = 0.0;        ///< share of the scan's points that lie near an obstacle of the map there
  double mean_distance_m = 0.0;  ///< of the points to the map's obstacles, capped
};

/// When a robot is looked for.
struct TrackLimits {
  double lost_m = 2.0;             ///< after so much path without a match nothing is known any more
  std::uint32_t doubt_scans = 5;   ///< so many scans without a match: it may have been carried away
  std::uint32_t search_every = 5;  ///< while it is looked for, one scan of so many is searched
};

class RobotTracker {
 public:
  /// Localizer and CPU must outlive this. Throws what MapTracker throws.
  RobotTracker(const Localizer& localizer, const MapperConfig& config, Backend& cpu, const TrackLimits& limits = {});

  /// The next scan of the drive, with the robot's pose by its wheels if there is one. Throws DeviceError.
  TrackedPose follow(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);

  /// Searches of the whole map so far.
  [[nodiscard]] std::uint64_t searches() const { return searches_; }

 private:
  [[nodiscard]] TrackedPose in_map(const MatchResult& match, Whereabouts whereabouts) const;
  [[nodiscard]] bool is_good(const MatchResult& match) const;
  void count(const MatchResult& match);
  [[nodiscard]] bool is_search_due();

  const Localizer& localizer_;
  TrackLimits limits_;
  MapTracker tracker_;
  bool is_known_ = false;
  std::uint64_t scans_ = 0;
  std::uint64_t searches_ = 0;
  double unmatched_m_ = 0.0;  // path since the last good match
  std::uint32_t unmatched_scans_ = 0;
  std::uint32_t since_search_ = 0;  // scans; 0 where none is going on
  Pose2 last_;                      // pose, in the kernels' frame
};

}  // namespace gdtslam
