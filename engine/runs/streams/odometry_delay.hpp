// By how much odometry lags behind the laser: recorders stamp both when they arrive, and one may come late. The turns
// of the robot by its scans are laid on those by its odometry; the shift at which they agree best is the delay. Not
// thread-safe.
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

/// Returns none if the robot turned too little. Shifts of up to 1.5 s either way are tried; each difference
/// counts up to some degrees, so that slips and wrong matches are a few of many. Cost: some milliseconds a thousand
/// headings.
std::optional<OdometryDelay> estimate_delay(std::span<const TimedHeading> headings);

std::vector<TimedHeading> to_headings(std::span<const TimedMotion> motions);

/// Gives scans the odometry that was stamped a delay later than they, once it has come; of the same stretch of the
/// clock, where that was set back. A scan whose stamp is wild gets that of where it was read between the others.
class OdometryShift {
 public:
  explicit OdometryShift(double delay_s) : delay_s_(delay_s) {}
  [[nodiscard]] double delay_s() const { return delay_s_; }
  void take(ScanRecord scan);
  /// The next scan whose odometry is there; with `at_end` also those that wait, with the last that is known.
  std::optional<ScanRecord> next(bool at_end);

 private:
  struct Waiting {
    ScanRecord scan;
    std::uint64_t stretch = 0;
    double stamp_s = 0.0;   ///< its own, unless that is wild
    bool is_placed = true;  ///< no later scan changes what is above
  };
  void place_again();
  [[nodiscard]] Pose2 odometry_at(const Waiting& waiting) const;

  double delay_s_;
  OdometryTrack track_;
  std::deque<Waiting> waiting_;
};

}  // namespace gdtslam
