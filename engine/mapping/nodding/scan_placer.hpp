// Computes poses and points of all scans from the few that have a pose: between two fixes by equation (13), smoothed if
// the scans see walls; before the first fix, after the last one and in long gaps by odometry. Frame: map. Memory: the
// scans since the last fix. One placer belongs to one thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {

/// Destination of the points, and the poses, in log order.
struct PlacedScans {
  Backend& backend;  ///< makes points of beams
  CloudSink& cloud;
  NoddingMapper::PoseSink poses;
  MapperOptions on_failure;
};

class ScanPlacer {
 public:
  /// Returns the map for the smoother; called when it is needed.
  using FieldSource = std::function<const GlobalField&()>;

  /// `valid` gives the limits of valid ranges.
  ScanPlacer(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid, FieldSource field,
             PlacedScans placed);
  ~ScanPlacer();
  /// Takes the next scan in log order. Throws DeviceError if the device failed and on_failure forbids to continue with
  /// the CPU.
  void take(NoddingScan scan);
  /// Takes the next scan with its pose from the 2D system; only an accepted match fixes a pose, or the first one.
  void take_fix(NoddingScan scan, const Pose2& T_map_base, const MatchResult& match);
  /// Stops points and smoothing from here on: only the remaining poses follow.
  void leave_points();
  /// Call it when the log has ended; there must have been a fix.
  void finish();

  [[nodiscard]] bool has_fix() const;
  /// All counts except the strokes.
  [[nodiscard]] const NoddingStatistics& statistics() const;
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
