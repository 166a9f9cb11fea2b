// How the grids of this part grow: by boxes of cells, with room to spare.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// No map reaches farther from the anchor cell, in cells along each axis.
inline constexpr std::int64_t kFurthestCell = 1 << 30;

/// The smallest box that holds both; an empty one adds nothing.
CellBox bounding_box(const CellBox& a, const CellBox& b);
/// Intersection of both boxes; may be empty.
CellBox common_part(const CellBox& a, const CellBox& b);

/// "3 x 4 cells".
std::string size_text(const CellBox& box);

/// Box that a grid has to hold and the one that is stored for it; map cells.
struct GridBoxes {
  CellBox content;
  CellBox stored;
};

/// The boxes of a grid that holds `box` too; nothing where its content alone would be too much. Each side that moves
/// gets a margin of a quarter of the extent, or the largest part of it that fits, so that a long drive copies the grid
/// a few times only. Where earlier margins are in the way they are given up, so that `stored` does not hold all of what
/// it held, but all of the content.
std::optional<GridBoxes> grown_to_hold(const GridBoxes& now, const CellBox& box,
                                       const std::function<bool(const CellBox&)>& fits);

}  // namespace gdtslam
