// Changes in a map that a drive in it shows. Only scans count that were matched well while the
// robot was followed, in no doubt about where that is. Frame: the map's, metres. One object belongs to one thread.
// Cost: engine/mapping/changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/changes/view_counts.hpp"
#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "map_field.hpp"

namespace gdtslam {

class DriveChanges {
 public:
  /// In the map that the field belongs to; where that is a run's, the scans that it was made from count, too. Throws
  /// InputError where it is a run's that has no map.pgm, FileError.
  DriveChanges(const MapField& field, const MapperConfig& config, const ChangeLimits& limits);

  /// The next scan of the drive. Throws InputError.
  void see(const LaserScan& scan, const TrackedPose& pose);

  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  [[nodiscard]] const ChangeLimits& limits() const { return limits_; }
  [[nodiscard]] std::size_t views() const { return views_.views(); }
  /// Places where they were taken, in stretches without a gap.
  [[nodiscard]] const std::vector<Trajectory>& stretches() const { return stretches_; }
  [[nodiscard]] MapChanges found() const { return find_changes(map_, views_, before_ ? &*before_ : nullptr, limits_); }

 private:
  void see_what_was_before(const MapField& field, const MapperConfig& config);
  [[nodiscard]] Pose2 in_grid(const Pose2& T_map_base) const;

  OccupancyMap map_;
  ChangeLimits limits_;
  ViewCounts views_;
  std::optional<ViewCounts> before_;
  std::vector<Trajectory> stretches_;
  bool is_seeing_ = false;
};

/// x_m,y_m,change,place,ended,passed: a line for each cell that changed, its centre in the map's frame.
std::string changes_table(const GridGeometry& grid, const MapChanges& changes);

}  // namespace gdtslam
