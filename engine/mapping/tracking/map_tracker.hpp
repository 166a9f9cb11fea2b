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
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// How a scan lies on the part of a map that it reaches.
struct KnownFit {
  double share = 0.0;  ///< share of its points that are nearer to an obstacle of the map than distances are kept
  double mean_distance_m = 0.0;  ///< mean distance of those points
  /// Share of its points that the map explains: they lie within the last gate of a match. The others may have come or
  /// gone since the map was made.
  double explained = 0.0;
  double explained_distance_m = 0.0;  ///< mean of those points
};

class MapTracker {
 public:
  /// The field is copied. `cpu` must be the CPU and outlive this. Resolution and truncation of the configuration do not
  /// count, those of the field do. Throws ConfigError that names every violation, InputError where the map would be
  /// beyond map.max_megacells.
  MapTracker(const MapperConfig& config, const FieldView& map, Backend& cpu);
  ~MapTracker();
  MapTracker(MapTracker&&) noexcept;
  MapTracker& operator=(MapTracker&&) noexcept;

  /// The robot is there, whatever was known before. The map's origin until this is called.
  void start_at(const Pose2& T_map_base);
  /// The robot's pose at the next scan with its evidence, as Mapper::process(); nothing is merged, and the wheels are
  /// not weighed (T_odometry_step and its sigmas stay as they are made). The first scan after start_at() was taken
  /// there or a step away.
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);
  /// How sure that pose is within the map: by what the scan shows where it was matched, along what it does not show by
  /// the way that led there, and by that alone where it was not.
  [[nodiscard]] PoseCovariance covariance() const;
  /// Fit of the last scan at that pose.
  [[nodiscard]] const KnownFit& known_fit() const;
  /// Another tracker in the same field, which is not copied; as configured, the robot at the map's origin.
  [[nodiscard]] MapTracker another() const;

 private:
  struct State;
  explicit MapTracker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
