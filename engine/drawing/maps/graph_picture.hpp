// The graph of a run over its map: where loops hold the path, which were found and are not believed, how sure each pose
// is, and which stretches are not to be trusted. Frame: map, metres, y up. Thread-safe; O(cells + pixels + poses +
// loops). Sheet, words and sizes are those of map_picture.hpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gdtslam/core/pose.hpp"
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

/// What lies over the map.
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

}  // namespace gdtslam
