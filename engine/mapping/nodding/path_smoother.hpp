// The robot's path between two fixes from its odometry and from what its scans see of the map meanwhile: the poses that
// make odometry and walls agree best, by Gauss and Newton on the map's distances and its gradient. Both ends stay. It
// starts from the odometry and only looks nearby, so it cannot jump; a direction in which no wall holds the robot is
// left to the odometry. Frame: map. Cost: about 0.1 ms for each decimetre of the path. Not thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "path_noise.hpp"
#include "pose_path.hpp"

namespace gdtslam {

/// Points of scan k of the nodes, robot frame; empty where it has none.
using PointsOfNode = std::function<std::vector<Point2>(std::size_t k)>;

/// Information of points, robot frame, about a pose.
PointsView view_from(const SmootherConfig& config, const GlobalField& field, const Pose2& T_map_base,
                     const std::vector<Point2>& points);

/// Corrects the nodes' T_map_base, placed between the fixes by place_between(); returns how many nodes' points helped.
std::size_t smooth_path(const SmootherConfig& config, const GlobalField& field, const PoseFix& from, const PoseFix& to,
                        std::vector<PoseFix>& nodes, const PointsOfNode& node_points);

}  // namespace gdtslam
