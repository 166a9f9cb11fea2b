// Follows a robot in a map that does not change: each scan is matched near the odometry's prediction, as a mapper does,
// and nothing is merged. Frame: the map's, metres and radians; if the map's cells do not lie on its origin's lattice,
// the robot is followed in a separate frame that does. One tracker belongs to one thread. Cost: that of a match, below
// a millisecond.
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

/// Fit of a scan to the part of a map that it reaches.
struct KnownFit {
  double share = 0.0;  ///< share of its points that are closer to an obstacle of the map than the largest kept distance
  double mean_distance_m = 0.0;  ///< mean distance of those points
  /// Share of its points that the map explains: they lie within the last gate of a match. The others may have appeared
  /// or disappeared since the map was made.
  double explained = 0.0;
  double explained_distance_m = 0.0;  ///< mean of those points
};

class MapTracker {
 public:
  /// The field is copied. `cpu` must be the CPU and outlive this. Resolution and truncation come from the field, not
  /// from the configuration. Throws ConfigError that names every violation, InputError if the map would exceed
  /// map.max_megacells.
  MapTracker(const MapperConfig& config, const FieldView& map, Backend& cpu);
  ~MapTracker();
  MapTracker(MapTracker&&) noexcept;
  MapTracker& operator=(MapTracker&&) noexcept;

  /// Sets the robot's pose, whatever was known before. Before the first call it is the map's origin.
  void start_at(const Pose2& T_map_base);
  /// The robot's pose at the next scan with its evidence, as Mapper::process(); nothing is merged, and the wheels are
  /// not weighed (T_odometry_step and its sigmas keep their defaults). The first scan after start_at() must be taken at
  /// that pose or a step away.
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);
  /// Covariance of that pose within the map. A matched scan determines the directions that it shows; the preceding
  /// motion determines the others, and all of them without a match.
  [[nodiscard]] PoseCovariance covariance() const;
  /// Fit of the last scan at that pose.
  [[nodiscard]] const KnownFit& known_fit() const;
  /// Another tracker in the same field, which is not copied; same configuration, the robot at the map's origin.
  [[nodiscard]] MapTracker another() const;

 private:
  struct State;
  explicit MapTracker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
