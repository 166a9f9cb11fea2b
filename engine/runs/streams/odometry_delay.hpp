// Delay of odometry after the laser: recorders stamp both on arrival, and one may arrive late. The robot's turns by its
// scans are compared with its turns by odometry; the shift with the best agreement is the delay. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "engine/io/recordings/odometry_track.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "scan_motion.hpp"

namespace gdtslam {

/// The robot's heading when a scan was taken: by odometry of the same stamp, and by the scans alone. Radians.
struct TimedHeading {
  double stamp_s = 0.0;
  double by_odometry_rad = 0.0;
  double by_scans_rad = 0.0;
};

/// Returns none if the robot turned too little. Shifts of up to 1.5 s either way are tried; differences are capped at
/// some degrees because of slips and wrong matches. Cost: some milliseconds for a thousand headings.
std::optional<OdometryDelay> estimate_delay(std::span<const TimedHeading> headings);

std::vector<TimedHeading> to_headings(std::span<const TimedMotion> motions);

/// Gives each scan the odometry stamped one delay later, once it has arrived. If the clock was set back, the odometry
/// is of the same stretch of the clock. A scan with a wild stamp is placed by its order in the log.
class OdometryShift {
 public:
  explicit OdometryShift(double delay_s) : delay_s_(delay_s) {}
  [[nodiscard]] double delay_s() const { return delay_s_; }
  void take(ScanRecord scan);
  /// The next scan with its odometry; with `at_end` also waiting scans, with the last known odometry.
  std::optional<ScanRecord> next(bool at_end);

 private:
  struct Waiting {
    ScanRecord scan;
    std::uint64_t stretch = 0;
    double stamp_s = 0.0;   ///< its own, unless that is wild
    bool is_placed = true;  ///< no later scan changes the members above
  };
  void place_again();
  [[nodiscard]] Pose2 odometry_at(const Waiting& waiting) const;

  double delay_s_;
  OdometryTrack track_;
  std::deque<Waiting> waiting_;
};

}  // namespace gdtslam
