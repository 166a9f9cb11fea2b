// What a drive that was followed in a map tells of changes there. Only scans count that were matched well where the
// robot was followed, in no doubt about where that is. Frame: the map's, metres. One object belongs to one thread. Cost:
// engine/mapping/changes.
#pragma once

#include <string>
#include <vector>

#include "drive.hpp"
#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/changes/view_counts.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "map_field.hpp"

namespace gdtslam {

/// Which cells of the map that the field belongs to are free and occupied. Throws InputError where it is a run's that
/// has no map.pgm, FileError.
OccupancyMap cells_of_map(const MapField& field);

class DriveChanges {
 public:
  DriveChanges(OccupancyMap map, const ScanConfig& scan, const ChangeLimits& limits, std::uint64_t max_cells);

  /// The next scan of the drive. Throws InputError.
  void see(const LaserScan& scan, const TrackedPose& pose);

  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  [[nodiscard]] const ChangeLimits& limits() const { return limits_; }
  [[nodiscard]] std::size_t views() const { return views_.views(); }
  /// Where they were taken, in stretches without a gap.
  [[nodiscard]] const std::vector<Trajectory>& stretches() const { return stretches_; }
  [[nodiscard]] MapChanges found() const { return find_changes(map_, views_, limits_); }

 private:
  OccupancyMap map_;
  ChangeLimits limits_;
  ViewCounts views_;
  std::vector<Trajectory> stretches_;
  bool is_seeing_ = false;
};

/// x_m,y_m,change,place,ended,passed: a line for each cell that changed, its centre in the map's frame.
std::string changes_table(const GridGeometry& grid, const MapChanges& changes);

}  // namespace gdtslam
