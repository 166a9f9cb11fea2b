// Evaluates all poses of a window, then descends from each of the best local minima: the global solution up to the
// grid's spacing.
#pragma once

#include <cstdint>
#include <vector>

#include "descents.hpp"
#include "engine/mapping/cost/objective.hpp"

namespace gdtslam {

/// A box of poses around a centre, sampled at a spacing; both ends included.
struct SearchWindow {
  CellPose centre;
  float half_xy_cells = 0.0F;
  float half_theta_rad = 0.0F;
  float step_cells = 1.0F;
  float step_rad = 0.01F;

  [[nodiscard]] std::uint32_t count_xy() const;  ///< samples along x (and along y)
  [[nodiscard]] std::uint32_t count_theta() const;
  [[nodiscard]] bool holds(const CellPose& pose) const;
  /// True if a pose lies within half a step of the edge; a window without extent has no edge.
  [[nodiscard]] bool has_at_edge(const CellPose& pose) const;
};

/// Costs every sample at the points' nearest cells and returns the `starts` best local minima of the grid, best first.
std::vector<CellPose> best_samples(Objective& objective, const SearchWindow& window, std::uint32_t starts);

}  // namespace gdtslam
