// Wheel encoders with errors, and the robot's odometry from their ticks by equation (5) of the paper. Metres of travel
// of the left and the right wheel; poses of the robot's centre. Constant time. Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::sim {

/// Two driven wheels with encoders, and their errors.
struct WheelModel {
  DifferentialDrive drive;         ///< the drive that the odometry assumes
  double track_width_scale = 1.0;  ///< true track width over the assumed one
  double left_scale = 1.0;         ///< travel measured by the encoder over true travel: a systematic error
  double right_scale = 1.0;
  double slip_m_per_sqrt_m = 0.0;  ///< standard deviation of the wheel's travel over ground after 1 m; a random walk
  double ticks_per_m = 5000.0;

  [[nodiscard]] double true_track_width_m() const { return drive.track_width_m * track_width_scale; }
};

/// Every violation, one sentence each.
std::vector<std::string> validate(const WheelModel& wheels);

/// Counts of both encoders.
struct WheelTicks {
  std::int64_t left = 0;
  std::int64_t right = 0;
  friend bool operator==(const WheelTicks&, const WheelTicks&) = default;
};

/// Counts wheel turns in ticks. The size of the errors does not depend on the number of readings.
class WheelEncoders {
 public:
  WheelEncoders(const WheelModel& wheels, const Random& random);
  /// Adds the true travel of both wheels since the last call.
  void advance(double left_m, double right_m);
  [[nodiscard]] WheelTicks ticks() const;

 private:
  [[nodiscard]] double seen(double travel_m, double scale, Random& random) const;

  WheelModel wheels_;
  Random left_random_;
  Random right_random_;
  double left_m_ = 0.0;
  double right_m_ = 0.0;
};

/// Pose from the ticks, starting at the origin.
class WheelOdometer {
 public:
  explicit WheelOdometer(const WheelModel& wheels) : wheels_(wheels) {}
  /// Takes the encoders' readings and returns T_odom_base.
  Pose2 update(const WheelTicks& ticks);

 private:
  WheelModel wheels_;
  WheelTicks last_;
  Pose2 T_odom_base_;
};

}  // namespace gdtslam::sim
