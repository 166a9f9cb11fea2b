// How the grids of this part grow: by boxes of cells, with room to spare.
#pragma once

#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// The smallest box that holds both; an empty one adds nothing.
CellBox hull_of(const CellBox& a, const CellBox& b);

/// `needed`, which holds `stored`, with a margin at each side that moved: a quarter of the extent, so that a long drive
/// copies the grid a few times only.
CellBox with_margin(const CellBox& stored, const CellBox& needed);

}  // namespace gdtslam
