// The maps as grids: states of cells, and the distance of each cell from an obstacle. Frame: map; row-major, the lower
// left cell first. Constant objects are thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// States of a map's cells in order: two bits each, and no memory for blocks of 512 unknown cells. One object belongs
/// to one thread; constant objects are thread-safe.
class CellStates {
 public:
  CellStates() = default;
  /// Makes `size` unknown cells.
  explicit CellStates(std::size_t size) : size_(size), blocks_((size + kBlock - 1) / kBlock) {}
  explicit CellStates(std::span<const CellState> states);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] CellState operator[](std::size_t cell) const {
    const std::uint32_t block = blocks_[cell / kBlock];
    return block == 0 ? CellState::kUnknown : state_in(pool_[block - 1], cell % kBlock);
  }
  void set(std::size_t cell, CellState state) {
    std::uint32_t& block = blocks_[cell / kBlock];
    if (block == 0) {
      if (state == CellState::kUnknown) return;
      pool_.push_back({});
      block = static_cast<std::uint32_t>(pool_.size());
    }
    std::uint64_t& word = pool_[block - 1][cell % kBlock / kInWord];
    const std::size_t shift = 2 * (cell % kInWord);
    word = (word & ~(std::uint64_t{3} << shift)) | static_cast<std::uint64_t>(state) << shift;
  }
  /// Reads the states from cell `first` on.
  void read(std::size_t first, std::span<CellState> states) const;
  [[nodiscard]] std::vector<CellState> all() const;
  friend bool operator==(const CellStates& a, const CellStates& b) { return a.all() == b.all(); }

 private:
  static constexpr std::size_t kBlock = 512;
  static constexpr std::size_t kInWord = 32;
  using Block = std::array<std::uint64_t, kBlock / kInWord>;
  static CellState state_in(const Block& block, std::size_t cell) {
    return static_cast<CellState>(block[cell / kInWord] >> (2 * (cell % kInWord)) & 3U);
  }

  std::size_t size_ = 0;
  std::vector<std::uint32_t> blocks_;  // 0, or the index in the pool plus one
  std::deque<Block> pool_;
};

/// Row-major, the lower left cell first; the smallest grid that holds everything seen.
struct OccupancyMap {
  GridGeometry geometry;
  CellStates cells;
  [[nodiscard]] CellState at(CellIndex cell) const {
    return cells[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(geometry.width) +
                 static_cast<std::size_t>(cell.x)];
  }
  /// The states of a row, of the geometry's width.
  void read_row(std::int32_t y, std::span<CellState> states) const {
    cells.read(static_cast<std::size_t>(y) * static_cast<std::size_t>(geometry.width), states);
  }
};

/// A distance field in memory: row-major, lower left cell first, `stride` cells from row to row.
struct DistanceFieldView {
  GridGeometry geometry;
  std::size_t stride = 0;
  std::span<const std::uint16_t> cells;
  std::uint16_t cap = 0;
  [[nodiscard]] std::uint16_t at(CellIndex cell) const {
    return cells[static_cast<std::size_t>(cell.y) * stride + static_cast<std::size_t>(cell.x)];
  }
};
/// Pictures of a field draw cells within this distance of an obstacle, in 1/256 cell, as wall.
inline constexpr std::uint16_t kWallOfField = 128;

/// A distance field that is read row by row, so that a field stored in another order need not be copied.
struct DistanceFieldRows {
  GridGeometry geometry;
  std::uint16_t cap = 0;
  std::function<void(std::int32_t y, std::span<std::uint16_t> row)> read;  ///< row y, of the geometry's width
};
DistanceFieldRows rows_of(const DistanceFieldView& field);

}  // namespace gdtslam
