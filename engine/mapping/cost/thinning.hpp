// An even share of the points of a scan.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {

/// Every n-th point, in order, so that at most `most` are left; all where there are no more.
inline void thin(std::span<const PointCells> points, std::size_t most, std::vector<PointCells>& thinned) {
  const std::size_t every = (points.size() + most - 1) / most;
  thinned.clear();
  for (std::size_t i = every / 2; i < points.size(); i += every) thinned.push_back(points[i]);
}

/// All points, those of thin() first; returns how many those are.
inline std::size_t put_thinned_first(std::span<const PointCells> points, std::size_t most,
                                     std::vector<PointCells>& ordered) {
  thin(points, most, ordered);
  const std::size_t count = ordered.size();
  const std::size_t every = (points.size() + most - 1) / most;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % every != every / 2) ordered.push_back(points[i]);
  }
  return count;
}

}  // namespace gdtslam
