// Figures of a scan that the page shows. Thread-safe, except the meter.
#pragma once

#include <chrono>
#include <cstdint>

#include "engine/runs/localizer/tracking.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "live_page.hpp"

namespace gdtslam {

/// Scans per second, over about the last second. Belongs to one thread.
class RateMeter {
 public:
  /// Counts one more scan; returns the rate.
  double count();

 private:
  using Clock = std::chrono::steady_clock;
  bool is_begun_ = false;
  Clock::time_point since_;
  std::uint64_t scans_ = 0;
  double rate_ = 0.0;
};

/// Progress of a drive.
struct DriveCounts {
  std::uint64_t scans = 0;
  std::uint64_t keyframes = 0;
  double path_m = 0.0;
  double scans_per_s = 0.0;
};

ShownScan shown_scan(const DriveCounts& counts, const ScanConfig& valid, const MappedScan& mapped);
ShownScan shown_scan(const DriveCounts& counts, const ScanConfig& valid, const LaserScan& scan,
                     const TrackedPose& pose);

}  // namespace gdtslam
