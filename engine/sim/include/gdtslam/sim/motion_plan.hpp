// Motion of a robot with two driven wheels along waypoints, in closed form: straight legs with bounded acceleration,
// rounded corners whose curvature rises from zero and falls back (heading = 3u^2 - 2u^3 of the turn, constant speed),
// turns on the spot with bounded turn rate and acceleration, pauses. Speed and turn rate are continuous. Frame: map;
// the pose is that of the axle's midpoint. Building is linear in the waypoints, a state logarithmic. state_at() is
// thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam::sim {

/// A place to drive to.
struct Waypoint {
  Point2 position_m{0.0, 0.0};
  std::optional<double> speed_m_per_s{};  ///< on the leg to here; empty: the limit
  std::optional<double> corner_cut_m{};   ///< at this corner; 0 turns on the spot
  double pause_s = 0.0;                   ///< pause at this waypoint
  bool is_reverse = false;                ///< the leg to here is driven backward
};

/// Limits of driving and turning.
struct MotionLimits {
  double speed_m_per_s = 0.7;
  double acceleration_m_per_s2 = 0.5;
  double turn_rate_rad_per_s = 1.0;
  double turn_acceleration_rad_per_s2 = 2.0;
  double corner_cut_m = 0.5;    ///< length of a rounded turn before and after its corner
  double spin_above_rad = 2.0;  ///< sharper corners become turns on the spot
};

/// Every violation, one sentence each.
std::vector<std::string> validate(const MotionLimits& limits);

/// The robot's pose and the distance driven so far.
struct MotionState {
  Pose2 T_map_axle;
  double speed_m_per_s = 0.0;  ///< negative backward
  double turn_rate_rad_per_s = 0.0;
  double travelled_m = 0.0;  ///< distance of the axle's midpoint, backward negative
  double turned_rad = 0.0;   ///< continuous beyond a full turn
  double path_m = 0.0;       ///< backward counted as positive
};

/// A pause.
struct Stand {
  double from_s = 0.0;
  double duration_s = 0.0;
};

/// The robot's motion over time.
class MotionPlan {
 public:
  /// A single waypoint must have a pause: the robot stands there with heading 0. Throws ConfigError without waypoints,
  /// for two that are closer than 1 cm, more than 100,000, values out of range, or a plan of more than a day.
  MotionPlan(const std::vector<Waypoint>& waypoints, const MotionLimits& limits);

  [[nodiscard]] double duration_s() const;
  [[nodiscard]] double path_m() const;
  /// The pauses in the order of their time.
  [[nodiscard]] std::vector<Stand> stands() const;
  /// Times outside [0, duration] are clamped.
  [[nodiscard]] MotionState state_at(double time_s) const;

 private:
  struct Segments;
  std::shared_ptr<const Segments> segments_;
};

}  // namespace gdtslam::sim
