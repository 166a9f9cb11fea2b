// The poses of a trajectory by the time that they belong to. Its order need not be that of time; poses without a
// finite stamp are left out. Thread-safe once made; O(n log n) to make, O(log n) to ask.
#pragma once

#include <optional>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class PosesByStamp {
 public:
  explicit PosesByStamp(Trajectory trajectory);
  /// The pose with the nearest stamp within the tolerance; of several with one stamp the last of the log counts.
  [[nodiscard]] std::optional<Pose2> find(double stamp_s, double tolerance_s) const;

 private:
  Trajectory poses_;
};

}  // namespace gdtslam
