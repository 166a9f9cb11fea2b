// Further pictures of a map, with the sheet, words and sizes of map_picture.hpp: the graph of a run, one moment of its
// loop closing, changes since the map was made, and paths without a map. Frame: map, metres, y up. Thread-safe; O(cells
// + pixels + poses + loops).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {

/// A loop between two poses.
struct LoopLine {
  std::size_t from = 0;  ///< indices into the trajectory
  std::size_t to = 0;
  double weight = 1.0;  ///< reliability, 0 to 1
  bool is_on = true;
};

/// A range of unreliable poses, the last one included.
struct PathStretch {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// A numbered entry of a list.
struct NumberedPlace {
  Point2 at_m = Point2::Zero();
  std::size_t number = 0;
};

/// Layers over the map.
struct GraphOverlay {
  Trajectory trajectory;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<LoopLine> loops;
  std::vector<PoseCovariance> covariances;  ///< one per pose, or none
  std::vector<PathStretch> doubtful;
  std::vector<NumberedPlace> numbers;
  std::vector<std::size_t> drives{};  ///< first poses of further drives: no line leads there
};

/// Grey walls, the path with its keyframes, accepted loops as lines in the colours of their weight, loops switched off
/// dashed, doubtful stretches as a broad band. Ellipses of three standard deviations follow the path at intervals; if
/// they would be too small, they are enlarged by a factor given in the legend. Throws InputError if an index is beyond
/// the trajectory or covariances are neither empty nor one per pose.
Canvas graph_picture(const OccupancyMap& map, const GraphOverlay& overlay, const MapLook& look,
                     const PictureSize& size);

/// Content shared by all moments.
struct LoopsScene {
  const OccupancyMap* map = nullptr;  ///< the run's map; must outlive the pictures
  Trajectory extent;                  ///< poses that must fit on the sheet, besides the map's walls
  bool has_loops_on = false;          ///< whether the legend explains accepted loops
  bool has_loops_off = false;
  double largest_sigma_m = 0.0;  ///< largest deviation of the robot's position in all moments; 0: no ellipse
};

/// A loop between two points.
struct MovedLoop {
  Point2 from_m = Point2::Zero();
  Point2 to_m = Point2::Zero();
  double weight = 1.0;
  bool is_on = true;
  double glow = 0.0;  ///< 1 for a new loop, fading to 0
};

struct LoopsMoment {
  std::vector<Point2> path_m;   ///< driven so far
  std::vector<Point2> walls_m;  ///< seen so far, each from its own place
  std::vector<MovedLoop> loops;
  std::optional<Point2> robot_m;  ///< empty: the drive is over
  PoseCovariance robot_covariance;
  double map_share = 0.0;  ///< opacity of the map over the walls, 0 to 1
};

Canvas loops_picture(const LoopsScene& scene, const LoopsMoment& moment, const MapLook& look, const PictureSize& size);

/// Cells of the map with their patches.
struct ChangesLayer {
  struct Cell {
    CellIndex cell;
    std::uint32_t patch = 0;  ///< from 0
  };
  std::vector<Cell> cells;
  std::uint32_t patches = 0;
};

struct ChangesOverlay {
  ChangesLayer appeared;
  ChangesLayer gone;
  std::vector<Trajectory> drives;  ///< drives that saw it, in pieces; no line joins them
};

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size);

/// Default size of a still for the area of these paths.
PictureSize size_for_paths(const std::vector<const Trajectory*>& paths);

/// The path as in the map's picture. Throws InputError if an index is beyond the trajectory.
Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size);

/// A path with its name for the legend.
struct NamedPath {
  std::string name;
  Trajectory trajectory;
  std::vector<std::size_t> drives{};
};
/// Each path in its own colour; the truth, if given, broad and grey under them.
Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size);

/// A path in the frame of the truth with the error at each pose; not a number if the truth lacks the stamp.
struct PathErrors {
  const Trajectory& trajectory;
  const std::vector<std::size_t>& drives;
  const std::vector<double>& errors;
  std::string quantity;         ///< with its unit: "Position error (m)"
  std::optional<double> least;  ///< lower end of the scale; empty: 0
  std::optional<double> most;   ///< upper end; empty: the largest error, or the 99th percentile
};
/// The truth thin and grey below; a colour bar with the scale's ends. Throws InputError without any error.
Canvas path_errors_picture(const PathErrors& path, const Trajectory& truth, const MapLook& look,
                           const PictureSize& size);

}  // namespace gdtslam
