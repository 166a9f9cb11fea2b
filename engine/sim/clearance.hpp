// How far places are from the nearest obstacle, seen from above: every part of a scene between two heights counts.
// Map frame, metres. Memory is linear in the triangles and places; a place takes some microseconds.
// Thread-safe.
#pragma once

#include <vector>

#include "gdtslam/sim/scene.hpp"

namespace gdtslam::sim {

/// Which obstacles count, and how far to look.
struct ClearanceQuery {
  double low_m = 0.0;  ///< only what lies between these two heights counts
  double high_m = 1.0;
  double limit_m = 1.0;  ///< the answer where nothing is nearer; above 0
};

/// The distance of each place to the nearest obstacle, in the order of the places; 0 within one.
std::vector<double> clearances_m(const TriangleMesh& mesh, const ClearanceQuery& query,
                                 const std::vector<Point2>& places_m);

}  // namespace gdtslam::sim
