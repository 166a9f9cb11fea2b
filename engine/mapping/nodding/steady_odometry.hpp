// The odometry of every scan without steps that are too long to be true: the 2D system sees that of horizontal scans
// alone, between which metres lie, and could not tell a leap from a drive.
#pragma once

#include <cstdint>
#include <optional>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

class SteadyOdometry {
 public:
  explicit SteadyOdometry(double max_step_m) : max_step_m_(max_step_m) {}
  /// The next scan's. Over a leap the robot stands, and what follows goes on from there; until then it is what was
  /// given, bit for bit. Nothing where it is not finite.
  std::optional<Pose2> take(const std::optional<Pose2>& T_odom_base);
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

 private:
  double max_step_m_;
  std::optional<Pose2> T_odom_last_;  // odometry that was given last
  std::optional<Pose2> T_steady_odom_;
  std::uint64_t leaps_ = 0;
};

}  // namespace gdtslam
