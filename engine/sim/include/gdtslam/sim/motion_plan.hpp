// How a robot with two driven wheels travels along waypoints, in closed form: straight legs with bounded acceleration,
// rounded corners whose curvature rises from zero and falls back (heading = 3u^2 - 2u^3 of the turn, constant speed),
// turns on the spot with bounded turn rate and acceleration, pauses. Speed and turn rate never jump. Frame: map; the
// pose is that of the middle of the wheel axle. Building is linear in the waypoints, a state logarithmic. state_at() is
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
  std::optional<double> speed_m_per_s{};  ///< on the leg to here; the limit where empty
  std::optional<double> corner_cut_m{};   ///< at this corner; 0 turns on the spot
  double pause_s = 0.0;                   ///< standing here
  bool is_reverse = false;                ///< the leg to here is driven backward
};

/// How fast the robot drives and turns.
struct MotionLimits {
  double speed_m_per_s = 0.7;
  double acceleration_m_per_s2 = 0.5;
  double turn_rate_rad_per_s = 1.0;
  double turn_acceleration_rad_per_s2 = 2.0;
  double corner_cut_m = 0.5;    ///< how far before and after a corner its turn reaches
  double spin_above_rad = 2.0;  ///< sharper corners are turned on the spot
};

/// Every violation, one sentence each.
std::vector<std::string> validate(const MotionLimits& limits);

/// The robot's place and the way of its wheels so far.
struct MotionState {
  Pose2 T_map_axle;
  double speed_m_per_s = 0.0;  ///< negative backward
  double turn_rate_rad_per_s = 0.0;
  double travelled_m = 0.0;  ///< way of the axle's middle, backward counted negative
  double turned_rad = 0.0;   ///< counted on beyond a full turn
  double path_m = 0.0;       ///< backward counted positive
};

/// A pause.
struct Stand {
  double from_s = 0.0;
  double duration_s = 0.0;
};

/// The robot's motion over time.
class MotionPlan {
 public:
  /// A single waypoint must have a pause: the robot stands there with heading 0. Throws ConfigError for no waypoint,
  /// two that are closer than 1 cm, more than 100,000, values out of range, or a plan of more than a day.
  MotionPlan(const std::vector<Waypoint>& waypoints, const MotionLimits& limits);

  [[nodiscard]] double duration_s() const;
  [[nodiscard]] double path_m() const;
  /// The pauses in the order of their time.
  [[nodiscard]] std::vector<Stand> stands() const;
  /// Times outside [0, duration] are moved to its ends.
  [[nodiscard]] MotionState state_at(double time_s) const;

 private:
  struct Segments;
  std::shared_ptr<const Segments> segments_;
};

}  // namespace gdtslam::sim
