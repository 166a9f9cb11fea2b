// Blocks of cells that wait on disk, against the same blocks in memory.
#include "engine/mapping/map/store/block_shelf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <vector>

#include "gdtslam/core/random.hpp"

namespace gdtslam::test {
namespace {

using BlockCells = std::vector<std::uint16_t>;
constexpr std::size_t kRowsOfTile = kTileOfStripCells / kStripStride;

BlockCells drawn_cells(Random& random) {
  BlockCells cells(kBlockCells);
  for (std::uint16_t& cell : cells) cell = static_cast<std::uint16_t>(1 + random.below(65535));
  return cells;
}

std::span<std::uint16_t, kBlockCells> all_of(BlockCells& cells) { return std::span<std::uint16_t, kBlockCells>(cells); }

/// What the shelf should have.
struct KnownBlock {
  TileSet tiles = 0;
  BlockCells cells;
};

void expect_rows(const BlockShelf& shelf, const std::map<BlockIndex, KnownBlock>& kept, BlockIndex block) {
  const auto found = kept.find(block);
  for (std::size_t row = 0; row < kRowsOfTile * kBlockTiles; row += 13) {
    BlockCells got(kStripWidth, 7);
    shelf.read_row(block, row, std::span<std::uint16_t, kStripWidth>(got));
    BlockCells expected(kStripWidth, 0);
    if (found != kept.end() && (found->second.tiles >> (row / kRowsOfTile) & 1) != 0) {
      const auto first = found->second.cells.begin() + static_cast<std::ptrdiff_t>(row * kStripStride);
      std::copy_n(first, kStripWidth, expected.begin());
    }
    EXPECT_EQ(got, expected) << block.x << ' ' << block.y << ", row " << row;
  }
}

TEST(BlockShelf, HasWhatWasPutUntilItIsTaken) {
  BlockShelf shelf(testing::TempDir());
  std::map<BlockIndex, KnownBlock> kept;
  Random random(5);
  EXPECT_TRUE(shelf.empty());
  for (int step = 0; step < 60; ++step) {
    const BlockIndex block{static_cast<std::int32_t>(random.below(2)), static_cast<std::int32_t>(random.below(3)) - 1};
    const auto found = kept.find(block);
    if (found == kept.end()) {
      KnownBlock put{static_cast<TileSet>(1 + random.below(255)), drawn_cells(random)};
      shelf.put(block, put.tiles, all_of(put.cells));
      kept[block] = std::move(put);
    } else if (random.below(2) == 0) {
      BlockCells got(kBlockCells, 0);
      EXPECT_EQ(shelf.take(block, all_of(got)), found->second.tiles);
      for (std::size_t k = 0; k < kBlockCells; ++k) {
        const bool is_known = (found->second.tiles >> (k / kTileOfStripCells) & 1) != 0;
        ASSERT_EQ(got[k], is_known ? found->second.cells[k] : 0) << "step " << step << ", cell " << k;
      }
      EXPECT_EQ(shelf.take(block, all_of(got)), 0) << "it is not there any more";
      kept.erase(found);
    }
    EXPECT_EQ(shelf.empty(), kept.empty());
    for (std::int32_t x = 0; x < 2; ++x) {
      for (std::int32_t y = -1; y < 2; ++y) {
        EXPECT_EQ(shelf.tiles_of({x, y}), kept.contains({x, y}) ? kept.at({x, y}).tiles : 0);
        expect_rows(shelf, kept, {x, y});
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
