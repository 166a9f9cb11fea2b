// From scans of which some have a pose to poses and points of all: between two fixes by equation (13), smoothed where
// the scans see walls; before the first, behind the last and blind for long by odometry. Frame: map. Memory: the scans
// since the last fix. One placer belongs to one thread.
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
  /// The map that the smoother looks at, asked for when it is needed.
  using FieldSource = std::function<const GlobalField&()>;

  /// `valid`: which ranges count.
  ScanPlacer(const NoddingConfig& config, const NoddingScanner& scanner, const ScanConfig& valid, FieldSource field,
             PlacedScans placed);
  ~ScanPlacer();
  /// The next scan in log order. Throws DeviceError where the device failed and on_failure forbids to go on with the
  /// CPU.
  void take(NoddingScan scan);
  /// The next scan, and where the 2D system put it; a match that was not accepted fixes nothing but the first pose.
  void take_fix(NoddingScan scan, const Pose2& T_map_base, const MatchResult& match);
  /// No more points from here on, and nothing is smoothed: only the rest of the poses.
  void leave_points();
  /// The log has ended; there was a fix.
  void finish();

  [[nodiscard]] bool has_fix() const;
  /// All but the strokes.
  [[nodiscard]] const NoddingStatistics& statistics() const;
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
