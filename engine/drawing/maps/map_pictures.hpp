// Pictures of a map beside those of map_picture.hpp, whose sheet, words and sizes they share. They show the graph of a
// run, one moment of its loops being closed, changes since the map was made, and paths without a map. Frame: map,
// metres, y up. Thread-safe; O(cells + pixels + poses + loops).
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
  double weight = 1.0;  ///< how far it is believed, from 0 to 1
  bool is_on = true;
};

/// Poses one after the other that are not to be trusted, the last one included.
struct PathStretch {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// A place that a list speaks of.
struct NumberedPlace {
  Point2 at_m = Point2::Zero();
  std::size_t number = 0;
};

/// Layers over the map.
struct GraphOverlay {
  Trajectory trajectory;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  std::vector<LoopLine> loops;
  std::vector<PoseCovariance> covariances;  ///< one a pose, or none
  std::vector<PathStretch> doubtful;
  std::vector<NumberedPlace> numbers;
  std::vector<std::size_t> drives{};  ///< poses at which another drive begins: no line leads there
};

/// Walls in grey, the path with its keyframes, loops that hold as lines in the colours of their weight, those that are
/// switched off dashed, ellipses of three standard deviations every some metres of path, enlarged by a factor that the
/// legend tells where they would be too small to be seen, and doubtful stretches as a broad band. Throws InputError
/// where an index is beyond the trajectory or covariances are neither none nor one a pose.
Canvas graph_picture(const OccupancyMap& map, const GraphOverlay& overlay, const MapLook& look,
                     const PictureSize& size);

/// Content that all moments share.
struct LoopsScene {
  const OccupancyMap* map = nullptr;  ///< the run's map; must outlive the pictures
  Trajectory extent;                  ///< poses that the sheet has room for, beside the map's walls
  bool has_loops_on = false;          ///< the legend explains these loops
  bool has_loops_off = false;
  double largest_sigma_m = 0.0;  ///< largest deviation of the robot's position in all moments; 0: no ellipse
};

/// A loop between two points.
struct MovedLoop {
  Point2 from_m = Point2::Zero();
  Point2 to_m = Point2::Zero();
  double weight = 1.0;
  bool is_on = true;
  double glow = 0.0;  ///< 1 when it has just been found, 0 some time later
};

struct LoopsMoment {
  std::vector<Point2> path_m;   ///< driven so far
  std::vector<Point2> walls_m;  ///< seen so far, from each place by itself
  std::vector<MovedLoop> loops;
  std::optional<Point2> robot_m;  ///< empty: the drive is over
  PoseCovariance robot_covariance;
  double map_share = 0.0;  ///< how far the walls have given way to the map itself, from 0 to 1
};

Canvas loops_picture(const LoopsScene& scene, const LoopsMoment& moment, const MapLook& look, const PictureSize& size);

/// Cells of the map, with the patch that each belongs to.
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
  std::vector<Trajectory> drives;  ///< on which it was seen, in pieces; no line leads from one to the next
};

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size);

/// Size of a still without a stated size: one that suits the area of these paths.
PictureSize size_for_paths(const std::vector<const Trajectory*>& paths);

/// The path as in the map's picture. Throws InputError if an index is beyond the trajectory.
Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size);

/// A path with its name for the legend.
struct NamedPath {
  std::string name;
  Trajectory trajectory;
  std::vector<std::size_t> drives{};
};
/// Each in a colour of its own; the truth, where there is one, broad and grey under them.
Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size);

/// A path in the frame of the truth with the error at each pose, which is no number where the truth has no such stamp.
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
