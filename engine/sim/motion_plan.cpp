#include "gdtslam/sim/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/sim/scene.hpp"
#include "motion_shapes.hpp"

namespace gdtslam::sim {
namespace {

constexpr std::size_t kMaxWaypoints = 100'000;
constexpr double kMaxDuration_s = 86'400.0;
constexpr double kMinLeg_m = 0.01;
// A corner's turn leaves at least a tenth of each leg straight.
constexpr double kMaxCutShare = 0.45;

struct Straight {
  SpeedProfile profile;
};
struct Spin {
  SpeedProfile profile;  // profile of the angle's magnitude
  double sign = 1.0;
};
struct Rounded {
  SmoothTurn turn;
  double speed_m_per_s = 0.0;
};
struct Standing {};

/// A piece of the motion, with the state at its start.
struct Segment {
  double start_s = 0.0;
  double duration_s = 0.0;
  double direction = 1.0;  // -1: backward
  MotionState start;
  std::variant<Straight, Spin, Rounded, Standing> shape;
};

struct Leg {
  double length_m = 0.0;
  double bearing_rad = 0.0;  // direction of the motion
  double heading_rad = 0.0;  // direction of the robot
  double direction = 1.0;
  double speed_m_per_s = 0.0;
};

/// The turn at a waypoint: its share of the adjoining legs, and its largest speed.
struct Joint {
  double cut_m = 0.0;
  double pass_speed_m_per_s = 0.0;  // 0: the robot stops
  double turn_rad = 0.0;
  double pause_s = 0.0;
};

[[noreturn]] void refuse(std::size_t waypoint, const std::string& fault) {
  throw ConfigError("waypoint " + std::to_string(waypoint + 1) + ": " + fault);
}

std::vector<Leg> legs_between(const std::vector<Waypoint>& waypoints, const MotionLimits& limits) {
  std::vector<Leg> legs;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const Point2 along = waypoints[i].position_m - waypoints[i - 1].position_m;
    Leg leg;
    leg.length_m = std::sqrt(along.x() * along.x() + along.y() * along.y());
    if (!(leg.length_m >= kMinLeg_m && leg.length_m <= 1e6)) {
      refuse(i, "must lie 1 cm to 1000 km from the one before");
    }
    leg.direction = waypoints[i].is_reverse ? -1.0 : 1.0;
    leg.bearing_rad = gdtslam::atan2(along.y(), along.x());
    leg.heading_rad = waypoints[i].is_reverse ? wrap_angle(leg.bearing_rad + kPi) : leg.bearing_rad;
    leg.speed_m_per_s = std::min(waypoints[i].speed_m_per_s.value_or(limits.speed_m_per_s), limits.speed_m_per_s);
    legs.push_back(leg);
  }
  return legs;
}

// The fastest constant speed within the limits of turn rate and turn acceleration (see SmoothTurn).
double turn_speed(const SmoothTurn& turn, const MotionLimits& limits) {
  const double angle_rad = std::fabs(turn.angle_rad());
  const double by_rate = limits.turn_rate_rad_per_s * turn.length_m() / (1.5 * angle_rad);
  const double by_acceleration = std::sqrt(limits.turn_acceleration_rad_per_s2 / (6.0 * angle_rad)) * turn.length_m();
  return std::min(by_rate, by_acceleration);
}

Joint joint_at(const Waypoint& waypoint, const Leg& before, const Leg& after, const MotionLimits& limits) {
  constexpr double kStraightOn_rad = 1e-9;
  Joint joint;
  joint.pause_s = waypoint.pause_s;
  joint.turn_rad = wrap_angle(after.heading_rad - before.heading_rad);
  const double cut_m = std::min(waypoint.corner_cut_m.value_or(limits.corner_cut_m),
                                kMaxCutShare * std::min(before.length_m, after.length_m));
  if (before.direction != after.direction || waypoint.pause_s > 0.0) {
    return joint;
  }
  const double slower = std::min(before.speed_m_per_s, after.speed_m_per_s);
  if (std::fabs(joint.turn_rad) <= kStraightOn_rad) {
    joint.pass_speed_m_per_s = slower;
  } else if (cut_m > 0.0 && std::fabs(joint.turn_rad) <= limits.spin_above_rad) {
    joint.cut_m = cut_m;
    joint.pass_speed_m_per_s = std::min(slower, turn_speed(SmoothTurn(joint.turn_rad, cut_m), limits));
  }
  return joint;
}

// Joint i belongs to waypoint i; the first and the last are stops.
std::vector<Joint> make_joints(const std::vector<Waypoint>& waypoints, const std::vector<Leg>& legs,
                               const MotionLimits& limits) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == waypoints.size();
    joints.push_back(is_end ? Joint{.pause_s = waypoints[i].pause_s}
                            : joint_at(waypoints[i], legs[i - 1], legs[i], limits));
  }
  return joints;
}

double straight_length(const std::vector<Leg>& legs, const std::vector<Joint>& joints, std::size_t leg) {
  return legs[leg].length_m - joints[leg].cut_m - joints[leg + 1].cut_m;
}

// Lowers the joints' speeds until each leg can connect them within the acceleration.
void respect_acceleration(const std::vector<Leg>& legs, std::vector<Joint>& joints, double acceleration) {
  const auto lower = [&](std::size_t to, std::size_t from, std::size_t leg) {
    const double start = joints[from].pass_speed_m_per_s;
    const double reachable = std::sqrt(start * start + 2.0 * acceleration * straight_length(legs, joints, leg));
    joints[to].pass_speed_m_per_s = std::min(joints[to].pass_speed_m_per_s, reachable);
  };
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    lower(leg + 1, leg, leg);
  }
  for (std::size_t leg = legs.size(); leg-- > 0;) {
    lower(leg, leg + 1, leg);
  }
}

MotionState state_in(const Segment& segment, double time_s) {
  MotionState state = segment.start;
  const Pose2& start = segment.start.T_map_axle;
  const double sign = segment.direction;
  state.speed_m_per_s = 0.0;
  state.turn_rate_rad_per_s = 0.0;
  if (const auto* straight = std::get_if<Straight>(&segment.shape)) {
    const ProfileState at = straight->profile.at(time_s);
    const Point2 moved = start * Point2(sign * at.distance, 0.0);
    state.T_map_axle = {moved.x(), moved.y(), start.theta_rad};
    state.speed_m_per_s = sign * at.rate;
    state.travelled_m += sign * at.distance;
    state.path_m += at.distance;
  } else if (const auto* spin = std::get_if<Spin>(&segment.shape)) {
    const ProfileState at = spin->profile.at(time_s);
    state.T_map_axle.theta_rad = wrap_angle(start.theta_rad + spin->sign * at.distance);
    state.turn_rate_rad_per_s = spin->sign * at.rate;
    state.turned_rad += spin->sign * at.distance;
  } else if (const auto* rounded = std::get_if<Rounded>(&segment.shape)) {
    const double share = std::min(1.0, rounded->speed_m_per_s * time_s / rounded->turn.length_m());
    // Backward the robot faces against its motion, so the turn's frame is rotated by half a turn.
    const Point2 moved = start * Point2(sign * rounded->turn.position_at(share));
    const double heading_rad = rounded->turn.heading_at(share);
    state.T_map_axle = {moved.x(), moved.y(), wrap_angle(start.theta_rad + heading_rad)};
    state.speed_m_per_s = sign * rounded->speed_m_per_s;
    state.turn_rate_rad_per_s = rounded->turn.curvature_at(share) * rounded->speed_m_per_s;
    state.travelled_m += sign * share * rounded->turn.length_m();
    state.path_m += share * rounded->turn.length_m();
    state.turned_rad += heading_rad;
  }
  return state;
}

/// Appends segments; each starts at the end of the previous one.
class Builder {
 public:
  Builder(const Pose2& start, const MotionLimits& limits) : limits_(limits) { at_.T_map_axle = start; }

  void drive(double length_m, double start_speed, double end_speed, const Leg& leg) {
    const SpeedProfile profile(length_m, start_speed, end_speed, leg.speed_m_per_s, limits_.acceleration_m_per_s2);
    append({time_s_, profile.duration_s(), leg.direction, at_, Straight{profile}});
  }
  void spin(double angle_rad) {
    const SpeedProfile profile(std::fabs(angle_rad), 0.0, 0.0, limits_.turn_rate_rad_per_s,
                               limits_.turn_acceleration_rad_per_s2);
    append({time_s_, profile.duration_s(), 1.0, at_, Spin{profile, angle_rad < 0.0 ? -1.0 : 1.0}});
  }
  void turn(const Joint& joint, double direction) {
    const SmoothTurn shape(joint.turn_rad, joint.cut_m);
    append({time_s_, shape.length_m() / joint.pass_speed_m_per_s, direction, at_,
            Rounded{shape, joint.pass_speed_m_per_s}});
  }
  void stand(double duration_s) { append({time_s_, duration_s, 1.0, at_, Standing{}}); }

  // Moves the pose back onto the leg, by some 1e-12 m, so that rounding does not add up along the plan.
  void align(const Pose2& T_map_axle) { at_.T_map_axle = T_map_axle; }

  std::vector<Segment> segments;
  [[nodiscard]] const MotionState& at() const { return at_; }
  [[nodiscard]] double time_s() const { return time_s_; }

 private:
  void append(Segment segment) {
    if (segment.duration_s <= 0.0) {
      return;
    }
    at_ = state_in(segment, segment.duration_s);
    time_s_ += segment.duration_s;
    segments.push_back(std::move(segment));
  }

  MotionLimits limits_;
  MotionState at_;
  double time_s_ = 0.0;
};

void add_joint(Builder& builder, const Joint& joint, double direction) {
  if (joint.pause_s > 0.0) {
    builder.stand(joint.pause_s);
  }
  if (joint.cut_m > 0.0) {
    builder.turn(joint, direction);
  } else if (joint.pass_speed_m_per_s == 0.0 && joint.turn_rad != 0.0) {
    builder.spin(joint.turn_rad);
  }
}

Pose2 start_of_straight(const Waypoint& waypoint, const Joint& joint, const Leg& leg) {
  const SinCos<double> bearing = sin_cos(leg.bearing_rad);
  return {waypoint.position_m.x() + joint.cut_m * bearing.cos, waypoint.position_m.y() + joint.cut_m * bearing.sin,
          leg.heading_rad};
}

Builder built(const std::vector<Waypoint>& waypoints, const MotionLimits& limits) {
  const Point2& first_m = waypoints.front().position_m;
  const std::vector<Leg> legs = legs_between(waypoints, limits);
  if (legs.empty()) {
    Builder builder({first_m.x(), first_m.y(), 0.0}, limits);
    builder.stand(waypoints.front().pause_s);
    return builder;
  }
  std::vector<Joint> joints = make_joints(waypoints, legs, limits);
  respect_acceleration(legs, joints, limits.acceleration_m_per_s2);
  Builder builder(start_of_straight(waypoints.front(), joints.front(), legs.front()), limits);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    add_joint(builder, joints[i], legs[i].direction);
    builder.align(start_of_straight(waypoints[i], joints[i], legs[i]));
    builder.drive(straight_length(legs, joints, i), joints[i].pass_speed_m_per_s, joints[i + 1].pass_speed_m_per_s,
                  legs[i]);
  }
  add_joint(builder, joints.back(), 1.0);
  return builder;
}

void check_waypoints(const std::vector<Waypoint>& waypoints) {
  const bool only_stands = waypoints.size() == 1 && waypoints.front().pause_s > 0.0;
  if ((waypoints.size() < 2 && !only_stands) || waypoints.size() > kMaxWaypoints) {
    throw ConfigError("a trajectory needs 2 to " + std::to_string(kMaxWaypoints) +
                      " waypoints, or one with a pause; this one has " + std::to_string(waypoints.size()));
  }
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const Waypoint& waypoint = waypoints[i];
    // Written so that a value that is not a number is refused.
    if (!(waypoint.speed_m_per_s.value_or(1.0) >= 0.01 && waypoint.speed_m_per_s.value_or(1.0) <= 100.0)) {
      refuse(i, "speed must be 0.01 to 100 m/s");
    }
    if (!(waypoint.corner_cut_m.value_or(0.0) >= 0.0 && waypoint.corner_cut_m.value_or(0.0) <= 100.0)) {
      refuse(i, "corner_cut must be 0 to 100 m");
    }
    if (!(waypoint.position_m.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
      refuse(i, "it must lie within 1000 m of the origin");
    }
    if (!(waypoint.pause_s >= 0.0 && waypoint.pause_s <= kMaxDuration_s)) {
      refuse(i, "pause must be 0 s to a day");
    }
  }
}

}  // namespace

struct MotionPlan::Segments {
  std::vector<Segment> list;
  MotionState end;
  double duration_s = 0.0;
};

std::vector<std::string> validate(const MotionLimits& limits) {
  std::vector<std::string> faults;
  const auto require = [&faults](double value, double low, double high, const char* fault) {
    if (!(value >= low && value <= high)) {
      faults.emplace_back(fault);
    }
  };
  require(limits.speed_m_per_s, 0.01, 100.0, "speed must be 0.01 to 100 m/s");
  require(limits.acceleration_m_per_s2, 0.001, 1000.0, "acceleration must be 0.001 to 1000 m/s^2");
  require(limits.turn_rate_rad_per_s, 0.01, 100.0, "turn_rate must be 0.01 to 100 rad/s");
  require(limits.turn_acceleration_rad_per_s2, 0.001, 1000.0, "turn_acceleration must be 0.001 to 1000 rad/s^2");
  require(limits.corner_cut_m, 0.0, 100.0, "corner_cut must be 0 to 100 m");
  require(limits.spin_above_rad, 0.0, 0.9 * kPi, "spin_above must be 0 to 162 deg");
  return faults;
}

MotionPlan::MotionPlan(const std::vector<Waypoint>& waypoints, const MotionLimits& limits) {
  if (const std::vector<std::string> faults = validate(limits); !faults.empty()) {
    throw ConfigError("motion: " + faults.front());
  }
  check_waypoints(waypoints);
  Builder builder = built(waypoints, limits);
  if (builder.time_s() > kMaxDuration_s) {
    throw ConfigError("the trajectory takes more than a day: raise the speed or shorten it");
  }
  segments_ = std::make_shared<const Segments>(
      Segments{.list = std::move(builder.segments), .end = builder.at(), .duration_s = builder.time_s()});
}

double MotionPlan::duration_s() const { return segments_->duration_s; }

double MotionPlan::path_m() const { return segments_->end.path_m; }

std::vector<Stand> MotionPlan::stands() const {
  std::vector<Stand> stands;
  for (const Segment& segment : segments_->list) {
    if (std::holds_alternative<Standing>(segment.shape)) {
      stands.push_back({segment.start_s, segment.duration_s});
    }
  }
  return stands;
}

MotionState MotionPlan::state_at(double time_s) const {
  const std::vector<Segment>& list = segments_->list;
  const double inside_s = std::clamp(time_s, 0.0, segments_->duration_s);
  const auto after = std::upper_bound(list.begin(), list.end(), inside_s,
                                      [](double t, const Segment& segment) { return t < segment.start_s; });
  const Segment& segment = *std::prev(after);
  return state_in(segment, std::min(inside_s - segment.start_s, segment.duration_s));
}

}  // namespace gdtslam::sim
