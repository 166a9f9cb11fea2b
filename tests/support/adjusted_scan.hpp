// One scan, adjusted to keyframes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/adjust/scan_adjustment.hpp"

namespace gdtslam::test {

inline Pose2 adjusted(const ScanAdjustment& adjustment, std::span<const LineScan> keyframes, const LineScan& scan,
                      const Pose2& pose, std::optional<std::size_t> last) {
  const std::vector<LineScan> scans{scan};
  std::vector<MovingScan> moving{{.number = 0, .last = last, .pose = pose}};
  WorkerPool workers(1);
  LinePairs lines(keyframes, workers, {});
  adjustment.adjust(scans, moving, lines, workers);
  return moving.front().pose;
}

}  // namespace gdtslam::test
