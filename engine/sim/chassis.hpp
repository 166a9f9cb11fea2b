// The robot's body in space: it stands on the floor below its four wheels, and sways over it. Metres, radians, map
// frame. Linear in the floor's parts. Thread-safe.
#pragma once

#include <array>

#include "gdtslam/sim/simulation.hpp"

namespace gdtslam::sim {

class Chassis {
 public:
  /// `config` must outlive it.
  explicit Chassis(const SimulationConfig& config);

  /// Whether roll and pitch are always zero and the height is the floor's.
  [[nodiscard]] bool is_level() const;
  [[nodiscard]] Pose3 T_map_base(const MotionState& state) const;
  /// Floor below the wheels: front left, front right, rear left, rear right.
  [[nodiscard]] std::array<double, 4> floor_below_m(const Pose2& T_map_base) const;
  /// Floor below the two driven wheels, left and right.
  [[nodiscard]] std::array<double, 2> floor_below_axle_m(const Pose2& T_map_axle) const;

 private:
  [[nodiscard]] double floor_m(const Pose2& T_map_frame, double x_m, double y_m) const;

  const SimulationConfig& config_;
  double half_track_m_;
  SineSum roll_;  ///< over metres of the path, like the next two
  SineSum pitch_;
  SineSum heave_;
};

}  // namespace gdtslam::sim
