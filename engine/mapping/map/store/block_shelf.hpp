// Blocks of a map's cells that wait on disk until the robot comes near them again. A block is eight tiles of 64 x 64
// cells, one above the other, as they lie in a strip of FieldStrips, their repeated cells included. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/memory/scratch_file.hpp"
#include "gdtslam/compute/kernel_options.hpp"

namespace gdtslam {

inline constexpr std::int32_t kBlockTiles = 8;  ///< of a block: a multiple of the system's pages
inline constexpr std::size_t kTileOfStripCells = std::size_t{kStripStride} * kStripWidth;
inline constexpr std::size_t kBlockCells = kTileOfStripCells * kBlockTiles;

/// A block by its column and row in the map; block (0, 0) has map cell (0, 0) in its lower left corner.
struct BlockIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator<(const BlockIndex& a, const BlockIndex& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }
};

/// Which tiles of a block are known: a bit each, the lowest tile first.
using TileSet = std::uint8_t;

class BlockShelf {
 public:
  /// The file is made with the first block, in that folder (ScratchFile).
  explicit BlockShelf(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// The tiles of the block that are kept here, none where it is not.
  [[nodiscard]] TileSet tiles_of(BlockIndex block) const;
  /// Keeps those tiles of the block's cells. Throws FileError where the disk is full; nothing is kept then.
  void put(BlockIndex block, TileSet tiles, std::span<const std::uint16_t, kBlockCells> cells);
  /// Fills in what is kept of the block, which is not here any more. Throws FileError.
  TileSet take(BlockIndex block, std::span<std::uint16_t, kBlockCells> cells);
  /// A row of a block's cells, 0 where they are unknown: as they are stored, 64 from its first on. Throws FileError.
  void read_row(BlockIndex block, std::size_t row, std::span<std::uint16_t, kStripWidth> cells) const;

 private:
  struct Place {
    std::uint64_t slot = 0;  // of the file
    TileSet tiles = 0;       // none while the block is with the map
  };
  /// The block of each column that rows were last read of.
  struct Copy {
    std::int32_t y = 0;
    std::vector<std::uint16_t> cells;
  };
  void read(const Place& place, std::span<std::uint16_t, kBlockCells> cells) const;

  std::string folder_;
  std::optional<ScratchFile> file_;
  std::map<BlockIndex, Place> places_;
  std::size_t count_ = 0;  // blocks that are here
  mutable std::map<std::int32_t, Copy> copies_;
};

}  // namespace gdtslam
