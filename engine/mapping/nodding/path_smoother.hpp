// The robot's path between two fixes from its odometry and from its scans: the poses at which odometry and walls agree
// best, by Gauss-Newton on the map's distances and their gradient. Both ends are fixed. It starts from the odometry and
// searches only nearby, so it cannot jump; in a direction that no wall constrains, the odometry alone counts. Frame:
// map. Cost: about 0.1 ms for each decimetre of the path. Not thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "path_noise.hpp"
#include "pose_path.hpp"

namespace gdtslam {

/// Points of scan k of the nodes, robot frame; empty if it has none.
using PointsOfNode = std::function<std::vector<Point2>(std::size_t k)>;

/// Information about a pose from points in the robot's frame.
PointsView view_from(const SmootherConfig& config, const GlobalField& field, const Pose2& T_map_base,
                     const std::vector<Point2>& points);

/// Corrects the nodes' T_map_base, placed between the fixes by place_between(); returns the number of nodes with points
/// that were used.
std::size_t smooth_path(const SmootherConfig& config, const GlobalField& field, const PoseFix& from, const PoseFix& to,
                        std::vector<PoseFix>& nodes, const PointsOfNode& node_points);

}  // namespace gdtslam
