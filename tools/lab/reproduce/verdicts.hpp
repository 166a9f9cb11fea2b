// What decides the verdicts of parts that take long to make, apart from making them. Thread-safe.
#pragma once

#include <span>
#include <vector>

#include "engine/runs/measuring/measure_table.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "tools/lab/reproduce/paper.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {

/// Table 2: an optimizer's time as a multiple of simplex's, `ratio`, held against the paper's factor.
Row time_row(const PaperColumn& paper, double ratio);

/// Figure 12: width, and where the boxes were measured in space the height too: only heights move with the linkage.
std::vector<Row> box_rows(const Measurement& measured);

/// Figures 14 and 15: how far the contours of a 2D map, of the 3D map from raised scans and of the truth agree, in the
/// plane to 5 cm. All in the map's frame; O(n log n) in the points.
struct ContourShares {
  double of_map = 0.0;    ///< of the occupied cells: a raised point is near
  double of_cloud = 0.0;  ///< of the cells over which raised points span 1 m of height: an occupied one is near
  double of_truth = 0.0;  ///< of the cells with true surfaces: a raised point is near
};
ContourShares contour_shares(const OccupancyMap& map, std::span<const CloudPoint> cloud, std::span<const Point2> truth);

}  // namespace gdtslam::reproduce
