// Changes of a map, found by views counted since it was made. A cell is new if views end in it repeatedly although the
// map has it as free, away from its walls. A cell is gone if the map has it as a wall and views pass through it and all
// its surroundings repeatedly. The evidence is that of an occupancy grid, hits against misses [Moravec1985], with a
// least number of views. So a lone return, glass that reflects now and then, and people walking by make no change.
// Frame: the cells of the map's grid. Thread-safe; O(cells seen x cells within the tolerance).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/mapping/map/scan_beams.hpp"
#include "engine/mapping/map/scan_marks.hpp"
#include "engine/mapping/map/tile_counts.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

// Counts the views of a drive that ended in each cell of a grid, and those that passed through it. A view is a scan
// taken some way from the previous view: a standing robot counts once, however long it stands. A beam counts as having
// passed only up to a tolerance before its end, so that noise and errors of poses wear no wall away. Frame: the grid's,
// whose cell (0, 0) has its lower left corner at the origin; metres and radians. Cost and memory: those of
// OccupancyBuilder. One object belongs to one thread, a constant one to all.

/// Views of one cell; no view counts twice.
using CellViews = TileCounts::Cell;

class ViewCounts {
 public:
  struct Limits {
    RayLimits rays;          ///< `short_of_end_m` is the tolerance
    double spacing_m = 0.2;  ///< distance between two views
    std::uint64_t max_cells = std::uint64_t{2048} << 20U;
  };
  explicit ViewCounts(const Limits& limits) : limits_(limits) {}

  /// Takes the scan as a view if it was taken far enough from the last one; returns true then. Throws InputError if the
  /// pose is not finite or the cells would exceed the limit.
  bool add(const LaserScan& scan, const Pose2& T_grid_base);
  [[nodiscard]] std::size_t views() const { return views_; }
  [[nodiscard]] CellViews at(CellIndex cell) const;

  /// The cells in which a view ended, or through which one passed; row by row within a tile, tiles by rows.
  [[nodiscard]] std::vector<CellIndex> ended() const;
  [[nodiscard]] std::vector<CellIndex> passed() const;

 private:
  using TilePlace = std::pair<std::int32_t, std::int32_t>;  ///< y, x
  template <class RowReader>
  [[nodiscard]] std::vector<CellIndex> collect_cells(RowReader read_row) const;
  void require_room();

  Limits limits_;
  ScanMarks marks_;
  std::vector<ScanRay> rays_;
  std::map<TilePlace, TileCounts> tiles_;
  std::optional<Point2> last_m_;
  std::size_t views_ = 0;
};

/// Evidence needed for a change.
struct ChangeLimits {
  double tolerance_m = 0.1;         ///< a return closer to a wall may be the wall; smaller things are not found
  double spacing_m = 0.2;           ///< distance between two views, which count as independent
  std::uint32_t least_views = 5;    ///< views that ended in a new cell, or passed through a gone one
  std::uint32_t beside_views = 2;   ///< views that ended in a cell within the tolerance of a new one: it belongs to it
  double least_share = 0.6;         ///< share of the views of a new cell that must end in it
  double most_contradicted = 0.15;  ///< ends within the tolerance for each view that passed through a gone cell
  double patch_gap_m = 0.3;         ///< cells closer to each other than this are one patch
};

/// A cell that changed, with its views.
struct ChangedCell {
  CellIndex cell;
  CellViews views;
  std::uint32_t patch = 0;  ///< from 0, by their first cells
};

/// New and gone cells, sorted by rows, then columns; patches extend at least over the tolerance.
struct MapChanges {
  std::vector<ChangedCell> appeared;
  std::vector<ChangedCell> gone;
  [[nodiscard]] bool empty() const { return appeared.empty() && gone.empty(); }
};

/// Number of patches.
std::size_t count_patches(std::span<const ChangedCell> cells);

/// `views` were counted in the map's grid, as were the views `before`, from which the map was made, if they are known.
/// These must have seen new cells as free, with all surroundings, and gone cells not as free. This excludes grazed
/// cells and glass.
MapChanges find_changes(const OccupancyMap& map, const ViewCounts& views, const ViewCounts* before,
                        const ChangeLimits& limits);

/// Judges single cells by their views.
class ViewJudge {
 public:
  ViewJudge(double resolution_m, const ChangeLimits& limits);
  /// Enough views passed through it, and they saw all of its surroundings, up to the tolerance, as free.
  [[nodiscard]] bool is_free(const ViewCounts& views, CellIndex cell) const;
  /// At least this many ended in it, and most of the views that saw it.
  [[nodiscard]] bool is_wall(const CellViews& views, std::uint32_t least_views) const;
  /// The cells within the tolerance of a cell, including itself.
  [[nodiscard]] const std::vector<CellOffset>& surroundings() const { return disc_; }

 private:
  ChangeLimits limits_;
  std::vector<CellOffset> disc_;
};

/// Sorts the cells, numbers the patches and leaves out those that are too small.
void keep_patches(std::vector<ChangedCell>& cells, double resolution_m, const ChangeLimits& limits);

}  // namespace gdtslam
