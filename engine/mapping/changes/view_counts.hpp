// How many views of a drive ended in each cell of a grid, and how many passed through it. A view is a scan from a place
// that lies some way from that of the view before: a robot that stands counts once, however long it stands. A beam that
// ends near a cell says nothing of it but there, so that noise and errors of poses wear no wall away: it counts as
// having passed up to a tolerance before its end only. Frame: the grid's, whose cell (0, 0) has its lower left corner
// at the origin; metres and radians. Cost and memory: those of OccupancyBuilder. One object belongs to one thread, a
// constant one to all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/mapping/map/scan_beams.hpp"
#include "engine/mapping/map/scan_marks.hpp"
#include "engine/mapping/map/tile_counts.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

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

  /// Takes the scan as a view if it was taken far enough from the last one; says whether. Throws InputError where the
  /// pose is not finite or the cells would be more than allowed.
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

}  // namespace gdtslam
