// The robot's path between two fixes from its odometry and from what its scans see of the map meanwhile: the poses that
// make odometry and walls agree best, by Gauss and Newton on the map's distances and its gradient. Both ends stay. It
// starts from the odometry and only looks nearby, so it cannot jump; a direction in which no wall holds the robot is
// left to the odometry. Frame: map. Cost: about 0.1 ms for each decimetre of the path. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/pose_interpolation.hpp"

namespace gdtslam {

struct SmootherConfig {
  bool is_on = true;
  double band_up_m = 1.5;       ///< points up to this much above the map's height count as walls
  double above_floor_m = 0.15;  ///< and down to this much above the floor
  double spacing_m = 0.1;       ///< of the poses that are estimated; those between lie on circles
  double spacing_rad = 0.05;
  double odometry_m_per_sqrt_m = 0.02;  ///< standard deviations of the odometry, a random walk
  double odometry_rad_per_sqrt_m = 0.03;
  double odometry_rad_per_sqrt_rad = 0.05;
  double point_sigma_m = 0.03;  ///< of a point's distance to the map
  double gate_m = 0.2;          ///< points farther from the map do not count
  std::int32_t max_points = 240;
  std::int32_t independent_points = 40;  ///< the points of a scan weigh no more than so many
  std::int32_t iterations = 4;
};

/// Points of scan k of the nodes, robot frame; empty where it has none.
using PointsOfNode = std::function<std::vector<Point2>(std::size_t k)>;

/// Corrects the nodes' T_map_base, which must hold a first estimate; returns how many nodes' points helped.
std::size_t smooth_path(const SmootherConfig& config, const GlobalField& field, const PoseFix& from, const PoseFix& to,
                        std::vector<PoseFix>& nodes, const PointsOfNode& points_of);

}  // namespace gdtslam
