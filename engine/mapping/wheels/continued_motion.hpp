// Predicts the robot's motion if no odometry measures it: the last motion continues, with an uncertainty learnt from
// earlier errors. Frame: the robot's at the last scan. Not thread-safe. Cost: some microseconds a scan.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

// Uncertainty of a motion. Thread-safe, constant time.

/// Standard deviations of a motion that the wheels measured, along each axis and in heading.
struct MotionNoise {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// Change of the motion of an unknown robot from scan to scan.
inline constexpr MotionNoise kOfAnyRobot{0.2, 0.2};

class ContinuedMotion {
 public:
  /// Takes the pose of the next scan, and whether a match confirms it.
  void take(const Pose2& T_map_base, bool is_known);

  /// Motion from the last scan to the next: that between scans of the last two known poses.
  [[nodiscard]] Pose2 step() const { return exp_tangent(velocity_); }
  /// Uncertainty of that motion: more with each scan whose pose is not known.
  [[nodiscard]] MotionNoise noise() const;

 private:
  /// The change of the motion from one scan to the next.
  struct Change {
    double m = 0.0;
    double rad = 0.0;
  };
  void learn(const Change& change);

  Tangent2 velocity_{};  // a scan
  std::optional<Pose2> T_map_known_;
  std::size_t unknown_ = 0;        // scans since the last known pose
  bool is_single_ = false;         // the velocity is from one scan to the next
  std::deque<Change> changes_;     // changes of the motion at the last scans
  std::vector<double> changes_m_;  // and each component in ascending order
  std::vector<double> changes_rad_;
  MotionNoise learnt_;  // noise of those motions
};

}  // namespace gdtslam
