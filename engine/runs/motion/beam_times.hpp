// When the beams of a scan were measured, as the scans themselves show it. While a robot turns, wrong times bend each
// scan by its own rate of turn, so two scans of different rates lie on each other only with the right times. Frame: the
// robot at the scan's stamp. Not thread-safe.
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

/// The time from the first beam of a scan to its last is its sweep; it is negative if the last beam was measured first.
struct BeamTimes {
  double sweep_s = 0.0;  ///< that lays scans on each other best
  double sigma_s = 0.0;
  double logged_sweep_s = 0.0;
  double share = 0.0;               ///< weighted share of the points that lie on the other scan
  double logged_share = 0.0;        ///< the same with the times of the log
  std::size_t better_tenths = 0;    ///< tenths of the pairs that fit better with the sweep that the other nine give
  double first_beam_after_s = 0.0;  ///< start of the best sweep, which begins when that of the log does
  double beam_period_s = 0.0;

  /// Whether the times of the log are wrong for certain, and by so much that it matters.
  [[nodiscard]] bool stands_out() const;
  [[nodiscard]] LogFinding finding() const;
  void state_in(ReadOptions& read) const;
};

/// Takes scans of one laser with their poses, in the order of the log.
class BeamTimesFit {
 public:
  void add(const LaserScan& scan, const Pose2& T_map_base);
  /// Returns none if the times of the log fit best, or the robot changed its rate of turn too seldom. Cost: some 0.1 s,
  /// for up to 200 pairs of scans that are laid on each other for three sweeps, and for 16 more if the log is wrong.
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
  std::vector<double> periods_s_;  ///< from scan to scan
};

}  // namespace gdtslam
