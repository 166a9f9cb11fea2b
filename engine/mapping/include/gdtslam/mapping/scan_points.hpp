// The valid returns of a scan as points. Frame: the robot (base_link), metres, so that a pose of the robot maps them
// into the map, paper equation (6). Thread-safe; linear in the beams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// End points of the valid beams in beam order, each seen from the laser's pose at the time of that beam, by the scan's
/// `speed`. A range that is not finite or outside min_range_m and max_range_m is no return (the scan's own limit
/// applies too, if the log states one; min_points has no effect here). Points that are not finite or 100 km away,
/// because a bearing or the mount is wrong, are dropped.
std::vector<Point2> to_points(const LaserScan& scan, const ScanConfig& valid);

/// The same for a sequence of scans: the directions of the beams are kept as long as the bearings stay.
class ScanPoints {
 public:
  explicit ScanPoints(const ScanConfig& valid) : valid_(valid) {}
  [[nodiscard]] std::vector<Point2> of(const LaserScan& scan);

 private:
  void update_directions(const LaserScan& scan);

  ScanConfig valid_;
  double first_bearing_rad_ = 0.0;
  double bearing_step_rad_ = 0.0;
  std::vector<Point2> directions_;  // cosine and sine
};

/// A scan whose returns are already points of the robot's plane, or scans of several lasers as one.
struct PointScan {
  double stamp_s = 0.0;
  std::vector<Point2> points_base_m;
  /// Number of points at the end that come from a laser without earlier scans in the map. They are not matched, and the
  /// scan is a keyframe.
  std::size_t unknown_points = 0;
};

/// The same points in cells.
std::vector<PointCells> in_cells(const std::vector<Point2>& points_m, double resolution_m);

/// The points at a pose of the robot, in the map's frame, paper equation (6).
std::vector<Point2> in_map(const std::vector<Point2>& points_m, const Pose2& T_map_base);

/// The cell of a point in the map's frame; coordinates beyond +-2^28 cells are clamped.
CellIndex map_cell_at(const Point2& point_map_m, double resolution_m);

/// Paper equation (7): the box of the cells that contain the points (map's frame), grown by `margin` cells on every
/// side, in map cells. Empty without points.
CellBox points_window(const std::vector<Point2>& points_map_m, double resolution_m, std::int32_t margin);

/// A keyframe as input of the map: the cells that contain its points, in the window that they can change.
struct KeyframeCells {
  CellBox window;                    ///< map cells
  std::vector<std::uint32_t> cells;  ///< y * 65536 + x from the window's lower left cell
};

/// The window of (7) with a margin of the truncation radius. Throws InputError if it is wider or higher than 32767
/// cells.
KeyframeCells make_keyframe_cells(const std::vector<Point2>& points_map_m, double resolution_m,
                                  std::uint32_t radius_cells);

}  // namespace gdtslam
