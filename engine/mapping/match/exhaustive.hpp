// Evaluates all poses of a window, then descends from each of the best local minima: the global solution up to the
// grid's spacing.
#pragma once

#include <cstdint>
#include <functional>

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

struct ExhaustiveResult {
  CellPose pose;
  std::uint32_t cost = 0;
  std::uint32_t evaluations = 0;
  bool at_edge = false;  ///< the pose lies within half a step of the window's edge
};

/// Costs every sample, keeps the `starts` best local minima of the grid, polishes each by `descend`.
ExhaustiveResult search_window(Objective& objective, const SearchWindow& window, std::uint32_t starts,
                               const std::function<LocalMinimum(const CellPose&)>& descend);

}  // namespace gdtslam
