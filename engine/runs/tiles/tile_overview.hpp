// All tiles in one small map: a cell stands for a square of theirs, and is occupied where any of them is, else free
// where any is. One object belongs to one thread; O(cells of a tile) for each.
#pragma once

#include <span>

#include "gdtslam/mapping/occupancy.hpp"
#include "tile_maker.hpp"

namespace gdtslam {

class TileOverview {
 public:
  /// Of tiles in those places, of which there is one at least; at most 8192 cells a side.
  TileOverview(std::span<const CellIndex> places, double resolution_m);
  void add(const MapTile& tile);
  [[nodiscard]] OccupancyMap take() { return std::move(map_); }

 private:
  CellBox tiles_{};
  std::int32_t scale_ = 1;  // a power of two
  OccupancyMap map_;
};

}  // namespace gdtslam
