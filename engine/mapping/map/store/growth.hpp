// Growth of grids: by boxes of cells, with spare room.
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

/// The box that a grid must hold and the stored box around it; map cells.
struct GridBoxes {
  CellBox content;
  CellBox stored;
};

/// The boxes of a grid that holds `box` too; empty if its content alone is too much. Each side that moves gets a margin
/// of a quarter of the extent, or the largest part of it that fits, so that a long drive copies the grid only a few
/// times. Earlier margins are given up if they are in the way: then `stored` does not hold all of the earlier box, but
/// all of the content.
std::optional<GridBoxes> grown_to_hold(const GridBoxes& now, const CellBox& box,
                                       const std::function<bool(const CellBox&)>& fits);

}  // namespace gdtslam
