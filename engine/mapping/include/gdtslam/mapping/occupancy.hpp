// The occupancy map for planners and people: which cells are occupied, free or unknown, by casting the beams of every
// scan from its final pose. The state of a cell follows from the scans that ended in it and those that only passed
// through it [Moravec1985]. Each scan counts once per cell, an end before a pass, so neither the order of the beams nor
// their density near the sensor matters. Frame: map, its lattice that of the GDT; metres and radians. The cells that a
// beam crosses are exact for end points rounded to 1/256 cell (integer traversal after [AmanatidesWoo1987]). Cost:
// O(beams x rows or columns crossed) per scan. Memory: tiles of 64 x 64 cells along the beams, two bits a cell for each
// doubling of the scans that saw it; nothing is copied when the map grows. One builder belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// Rules for occupied and free cells.
struct OccupancyConfig {
  double occupied_share = 0.25;   ///< least share of ends among the scans that saw the cell
  std::int32_t min_ends = 2;      ///< fewest scans that must end in an occupied cell
  double no_return_free_m = 0.0;  ///< free space along a beam without return; 0: such beams free nothing
};

/// The table of the options, under "occupancy."; its rows point into `config`.
std::vector<Option> option_table(OccupancyConfig& config);

/// An occupancy map that is being made, scan by scan.
class OccupancyBuilder {
 public:
  struct Limits {
    double resolution_m = MapConfig{}.resolution_m;
    double min_range_m = ScanConfig{}.min_range_m;  ///< shorter ranges are dropped
    double max_range_m = ScanConfig{}.max_range_m;  ///< at or above it, or the sensor's own limit, a range is no return
    /// Limit of the kept cells, in whole tiles; the map around them, mostly unknown, may have four times as many.
    std::uint64_t max_cells = std::uint64_t{2048} << 20U;
  };
  OccupancyBuilder(const OccupancyConfig& config, const Limits& limits);
  ~OccupancyBuilder();

  /// Casts the scan's beams from the robot's final pose, each from the laser's pose at the time of that beam. Ranges
  /// that are not finite are no returns. Throws InputError when the map would pass max_cells; the builder is unchanged
  /// then.
  void add(const LaserScan& scan, const Pose2& T_map_base);

  /// The map of the scans added so far; one unknown cell if there are none.
  [[nodiscard]] OccupancyMap build() const;

 private:
  struct Ray;
  struct Bearings {
    double first_rad = 0.0;
    double step_rad = 0.0;
    std::vector<Point2> directions;
  };
  struct Tiles;

  void update_bearings(const LaserScan& scan);
  CellBox collect_rays(const LaserScan& scan, const Pose2& T_map_base);
  void require_room(const CellBox& content) const;
  void mark_rays(const CellBox& touched);
  void count_marks();

  OccupancyConfig config_;
  Limits limits_;
  CellBox content_{};  ///< map cells reached by rays
  std::unique_ptr<Tiles> tiles_;
  std::vector<Ray> rays_;
  Bearings bearings_;
};

}  // namespace gdtslam
