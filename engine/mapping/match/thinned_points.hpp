// Scans with more points than a matcher takes. Linear.
#pragma once

#include <cstddef>
#include <vector>

#include "gdtslam/compute/kernel_options.hpp"

namespace gdtslam {

/// Every k-th point, with the least k that leaves no more than `most`, which must not be 0.
inline void thin(std::vector<PointCells>& points, std::size_t most) {
  if (points.size() <= most) return;
  const std::size_t every = (points.size() + most - 1) / most;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
}

}  // namespace gdtslam
