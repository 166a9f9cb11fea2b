// A map with what is new and what is gone in it since it was made: new cells in blue, gone ones in orange, which also
// readers who do not tell red from green keep apart, each patch of them in a frame that is found on a large sheet, over
// pale walls. Frame: map, metres, y up. Thread-safe; O(cells + pixels + changes). Sheet, words and sizes are those of
// map_picture.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {

/// Cells of the map, with the patch that each belongs to.
struct ChangesLayer {
  struct Cell {
    CellIndex cell;
    std::uint32_t patch = 0;  ///< from 0
  };
  std::vector<Cell> cells;
  std::uint32_t patches = 0;
};

struct ChangesOverlay {
  ChangesLayer appeared;
  ChangesLayer gone;
  std::vector<Trajectory> drives;  ///< on which it was seen, in pieces; no line leads from one to the next
};

Canvas changes_picture(const OccupancyMap& map, const ChangesOverlay& overlay, const MapLook& look,
                       const PictureSize& size);

}  // namespace gdtslam
