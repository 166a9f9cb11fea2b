// Estimates from the scans when their beams were measured. While a robot turns, wrong times bend each scan by the
// robot's rate of turn, so two scans at different rates match only with the right times. Frame: the robot at the scan's
// stamp. Not thread-safe.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// The sweep of a scan is the time from its first beam to its last; negative if the last beam was measured first.
struct BeamTimes {
  double sweep_s = 0.0;  ///< the sweep with the best match of scans
  double sigma_s = 0.0;
  double logged_sweep_s = 0.0;
  double share = 0.0;               ///< weighted share of the points that lie on the other scan
  double logged_share = 0.0;        ///< the same with the times of the log
  std::size_t better_tenths = 0;    ///< tenths of the pairs that fit better with the sweep found from the other nine
  double first_beam_after_s = 0.0;  ///< start of the best sweep, the same as in the log
  double beam_period_s = 0.0;

  /// True if the times of the log are certainly and significantly wrong.
  [[nodiscard]] bool stands_out() const;
  [[nodiscard]] LogFinding finding() const;
  void state_in(ReadOptions& read) const;
};

/// Takes scans of one laser with their poses, in the order of the log.
class BeamTimesFit {
 public:
  void add(const LaserScan& scan, const Pose2& T_map_base);
  /// Returns none if the times of the log fit best, or the robot changed its rate of turn too seldom. Cost: some 0.1 s,
  /// for up to 200 pairs of scans, matched for three sweeps, and for 16 more if the log is wrong.
  [[nodiscard]] std::optional<BeamTimes> fit(const ScanConfig& valid) const;

 private:
  /// A scan with the robot's speed around its stamp.
  struct MovingScan {
    LaserScan scan;
    Pose2 T_map_base;
  };
  struct Pair {
    MovingScan fixed;
    MovingScan moving;
  };
  class Search;

  std::deque<MovingScan> last_;
  std::vector<Pair> pairs_;
  std::vector<double> periods_s_;  ///< times between scans
};

}  // namespace gdtslam
