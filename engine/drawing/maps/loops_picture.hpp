// One moment of a path whose loops are closed: how far the robot has come, where the path and the walls seen along it
// lie by the loops known so far, and how sure its place is. Frame: map, metres, y up. Thread-safe; O(cells + pixels +
// walls). Sheet, words and sizes are those of map_picture.hpp; all moments of one scene have the same legend and scale.
#pragma once

#include <optional>
#include <vector>

#include "engine/drawing/maps/graph_picture.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {

/// What all moments share.
struct LoopsScene {
  const OccupancyMap* map = nullptr;  ///< of the run; must outlive the pictures
  Trajectory extent;                  ///< poses that the sheet has room for, beside the map's walls
  bool has_loops_on = false;          ///< what the legend tells of
  bool has_loops_off = false;
  double largest_sigma_m = 0.0;  ///< of the robot's position in all moments; 0: no ellipse
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
  std::optional<Point2> robot_m;  ///< nothing: the drive is over
  PoseCovariance robot_covariance;
  double map_share = 0.0;  ///< how far the walls have given way to the map itself, from 0 to 1
};

Canvas loops_picture(const LoopsScene& scene, const LoopsMoment& moment, const MapLook& look, const PictureSize& size);

}  // namespace gdtslam
