// A robot followed in a map that stays as it is: each scan is matched near where the odometry says, as a mapper matches
// it, and nothing is merged. Frame: the map's, metres and radians; a map whose cells do not lie on its origin's lattice
// is followed in a frame of its own that does. One tracker belongs to one thread. Cost: that of a match, below a
// millisecond.
#pragma once

#include <memory>
#include <optional>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

class MapTracker {
 public:
  /// The field is copied. `cpu` must be the CPU and outlive this. Resolution and truncation of the configuration do not
  /// count, those of the field do. Throws ConfigError that names every violation, InputError where the map would be
  /// beyond map.max_megacells.
  MapTracker(const MapperConfig& config, const FieldView& map, Backend& cpu);
  ~MapTracker();
  MapTracker(const MapTracker&) = delete;
  MapTracker& operator=(const MapTracker&) = delete;

  /// The robot is there, whatever was known before. The map's origin until this is called.
  void start_at(const Pose2& T_map_base);
  /// The robot's pose at the next scan with its evidence, as Mapper::process(); nothing is merged, and the wheels are
  /// not weighed (T_odometry_step and its sigmas stay as they are made). The first scan after start_at() was taken
  /// there or a step away.
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
