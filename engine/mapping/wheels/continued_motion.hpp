// The robot's motion where no odometry measures it: it goes on as it did, and how far that is off is learnt from how
// far it was so far. Frame: the robot's at the last scan. Not thread-safe. Cost: some microseconds a scan.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

// How sure a motion is. Thread-safe, constant time.

/// Standard deviations of a motion that the wheels measured, along each axis and in heading.
struct MotionNoise {
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
};

/// How far the motion of a robot that nothing is known of may change from scan to scan.
inline constexpr MotionNoise kOfAnyRobot{0.2, 0.2};

class ContinuedMotion {
 public:
  /// Takes the pose of the next scan, and whether a match confirms it.
  void take(const Pose2& T_map_base, bool is_known);

  /// From the last scan to the next, as from scan to scan between the last two poses that are known.
  [[nodiscard]] Pose2 step() const { return exp_tangent(velocity_); }
  /// How far that may be off: more with each scan whose pose is not known.
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
  std::size_t unknown_ = 0;        // scans since
  bool is_single_ = false;         // the velocity is from one scan to the next
  std::deque<Change> changes_;     // motions of the last scans
  std::vector<double> changes_m_;  // and each part of them ascending
  std::vector<double> changes_rad_;
  MotionNoise learnt_;  // noise of those motions
};

}  // namespace gdtslam
