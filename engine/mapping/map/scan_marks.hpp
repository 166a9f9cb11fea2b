// Marks the cells that the beams of one scan cross and end in: a bit a cell, in tiles of 64 x 64 cells that are made
// when a beam reaches them. A beam along x is marked a row at a time, one along y a column at a time, up to 64 cells at
// once; the columns are turned into rows when they are read. Cells are exact for points on the odd multiples of 1/512
// cell (integer traversal after [AmanatidesWoo1987], a whole row a step). Frame: map cells. Cost: O(rows or columns and
// tiles crossed) per beam, 1.5 kB per tile. One object belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// Cells along each side of a tile.
inline constexpr std::int32_t kTileSide = 64;
/// One bit a cell: a word a row, the lowest bit the leftmost cell.
using TileBits = std::array<std::uint64_t, kTileSide>;

/// The tile that holds a cell.
inline CellIndex cell_tile(CellIndex cell) { return {cell.x >> 6, cell.y >> 6}; }

/// A point in odd multiples of 1/512 cell, so that none lies on the border of a cell.
struct SubCell {
  std::int64_t x = 1;
  std::int64_t y = 1;
  [[nodiscard]] CellIndex cell() const {
    return {static_cast<std::int32_t>(x >> 9), static_cast<std::int32_t>(y >> 9)};
  }
};

class ScanMarks {
 public:
  /// Marks of one tile.
  struct Tile {
    CellIndex place;     ///< in tiles: its lower left cell is 64 times that
    TileBits rows{};     ///< crossed
    TileBits columns{};  ///< crossed, a word a column, the lowest bit the lowest cell
    TileBits ends{};     ///< cells in which a beam ended
    [[nodiscard]] bool has_columns() const {
      std::uint64_t any = 0;
      for (const std::uint64_t column : columns) any |= column;
      return any != 0;
    }
  };

  /// Forgets all marks; from now on the cells of `box` may be marked.
  void clear(const CellBox& box);
  /// Marks all cells of the segment, including the last one.
  void add_ray(const SubCell& start, const SubCell& end);
  void add_end(CellIndex cell);

  /// The tiles with marks, in the order in which they were first reached.
  [[nodiscard]] std::size_t size() const { return used_; }
  [[nodiscard]] Tile& operator[](std::size_t k) { return *pool_[k]; }

 private:
  struct Segment;

  template <bool kAlongX, bool kForward>
  void cast(const Segment& segment);
  template <bool kAlongX>
  void mark_run(std::int64_t line, std::int64_t from, std::int64_t to);
  template <bool kAlongX>
  TileBits& tile_lines(std::int64_t along, std::int64_t across);
  Tile& tile_at(std::int64_t column, std::int64_t row) {
    Tile*& tile = places_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)];
    if (tile == nullptr) tile = &new_tile(column, row);
    return *tile;
  }
  Tile& new_tile(std::int64_t column, std::int64_t row);

  CellIndex origin_;           ///< the lower left cell of the lower left tile
  std::size_t columns_ = 0;    ///< number of tile columns
  std::vector<Tile*> places_;  ///< row-major; null without marks
  std::vector<std::unique_ptr<Tile>> pool_;
  std::size_t used_ = 0;  ///< number of pool tiles in use
};

/// Rows become columns: bit x of word y becomes bit y of word x.
void transpose(TileBits& bits);

}  // namespace gdtslam
