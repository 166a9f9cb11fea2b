#include "block_shelf.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr std::uint64_t kSlotBytes = kBlockCells * sizeof(std::uint16_t);

// Calls see(first, count) for each stretch of tiles that are known.
template <class See>
void for_each_stretch(TileSet tiles, See see) {
  const auto is_known = [known = unsigned{tiles}](std::size_t tile) { return (known >> tile & 1U) != 0; };
  for (std::size_t first = 0; first < kBlockTiles;) {
    if (!is_known(first)) {
      ++first;
      continue;
    }
    std::size_t end = first + 1;
    while (end < kBlockTiles && is_known(end)) ++end;
    see(first, end - first);
    first = end;
  }
}

}  // namespace

TileSet BlockShelf::tiles_of(BlockIndex block) const {
  const auto found = places_.find(block);
  return found == places_.end() ? TileSet{0} : found->second.tiles;
}

void BlockShelf::put(BlockIndex block, TileSet tiles, std::span<const std::uint16_t, kBlockCells> cells) {
  if (!file_) file_.emplace(folder_);
  const std::uint64_t next = places_.size();
  const Place place{places_.contains(block) ? places_.at(block).slot : next, tiles};
  for_each_stretch(tiles, [&](std::size_t first, std::size_t count) {
    file_->write(place.slot * kSlotBytes + first * kTileOfStripCells * sizeof(std::uint16_t),
                 std::as_bytes(cells.subspan(first * kTileOfStripCells, count * kTileOfStripCells)));
  });
  copies_.erase(block.x);
  count_ += tiles_of(block) == 0 ? 1U : 0U;
  places_[block] = place;
}

void BlockShelf::read(const Place& place, std::span<std::uint16_t, kBlockCells> cells) const {
  for_each_stretch(place.tiles, [&](std::size_t first, std::size_t count) {
    file_->read(place.slot * kSlotBytes + first * kTileOfStripCells * sizeof(std::uint16_t),
                std::as_writable_bytes(cells.subspan(first * kTileOfStripCells, count * kTileOfStripCells)));
  });
}

TileSet BlockShelf::take(BlockIndex block, std::span<std::uint16_t, kBlockCells> cells) {
  const auto found = places_.find(block);
  if (found == places_.end() || found->second.tiles == 0) return 0;
  read(found->second, cells);
  copies_.erase(block.x);
  --count_;
  return std::exchange(found->second.tiles, TileSet{0});
}

void BlockShelf::read_row(BlockIndex block, std::size_t row, std::span<std::uint16_t, kStripWidth> cells) const {
  const auto found = places_.find(block);
  if (found == places_.end() || found->second.tiles == 0) {
    std::fill(cells.begin(), cells.end(), std::uint16_t{0});
    return;
  }
  Copy& copy = copies_[block.x];
  if (copy.cells.empty() || copy.y != block.y) {
    copy.y = block.y;
    copy.cells.assign(kBlockCells, 0);
    read(found->second, std::span<std::uint16_t, kBlockCells>(copy.cells));
  }
  std::copy_n(copy.cells.begin() + static_cast<std::ptrdiff_t>(row * kStripStride), kStripWidth, cells.begin());
}

}  // namespace gdtslam
