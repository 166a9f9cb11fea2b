#include "field_strips.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <stdexcept>
#include <utility>

#include "engine/core/memory/page_memory.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"

namespace gdtslam {
namespace {

constexpr auto kSide = static_cast<std::int32_t>(kStripWidth);  // of a tile, cells
constexpr std::int32_t kBlockRows = kSide * kBlockTiles;        // cells
// As many as 32 bits count the cells of, and as the kernels take along a side.
constexpr std::int64_t kMostTiles = (std::int64_t{1} << 32U) / static_cast<std::int64_t>(kTileOfStripCells);
constexpr std::int32_t kMostTilesOfASide = (1 << 21) / kSide - 1;
// A piece of address space is a square of so many tiles a side, where the process may have 8 GB of it.
constexpr std::int32_t kWideSide = 960;
constexpr std::int32_t kLeastMargin = 16;  // tiles
// Of a map that may wait on disk: what is brought near around the box that is asked for, what stays around that, the
// tiles that are in memory before any goes, and the blocks that go, or are looked at for it, with one scan:
// milliseconds.
constexpr std::int32_t kNearMargin = 8;
constexpr std::int32_t kFarMargin = 32;
constexpr std::uint64_t kMostHere = 12000;  // 104 MB
constexpr std::size_t kMostPutAway = 32;
constexpr std::size_t kMostPassedOver = 8192;

std::int32_t floor_to(std::int32_t cell, std::int32_t side) { return (cell >= 0 ? cell : cell - (side - 1)) / side; }

CellBox tiles_that_hold(const CellBox& box) {
  return {{floor_to(box.min.x, kSide), floor_to(box.min.y, kSide)},
          {floor_to(box.end.x - 1, kSide) + 1, floor_to(box.end.y - 1, kSide) + 1}};
}

std::int64_t count_of(const CellBox& tiles) { return std::int64_t{tiles.width()} * tiles.height(); }
std::size_t bytes_of(const CellBox& tiles) {
  return static_cast<std::size_t>(count_of(tiles)) * kTileOfStripCells * sizeof(std::uint16_t);
}

CellBox with_margin(const CellBox& tiles, std::int32_t x, std::int32_t y) {
  return {tiles.min - CellOffset{x, y}, tiles.end + CellOffset{x, y}};
}

CellBox in_whole_blocks(CellBox tiles) {
  tiles.min.y = floor_to(tiles.min.y, kBlockTiles) * kBlockTiles;
  tiles.end.y = (floor_to(tiles.end.y - 1, kBlockTiles) + 1) * kBlockTiles;
  return tiles;
}

// Pieces of address space that hold the tiles, from the one that is wanted most to the least one.
std::vector<CellBox> pieces_for(const CellBox& tiles) {
  std::vector<CellBox> pieces;
  if (tiles.width() <= kWideSide && tiles.height() <= kWideSide) {
    pieces.push_back(
        in_whole_blocks(with_margin(tiles, (kWideSide - tiles.width()) / 2, (kWideSide - tiles.height()) / 2)));
  }
  for (std::int32_t share = 2; share <= 32; share *= 4) {
    const auto margin = [share](std::int32_t extent) { return std::max(kLeastMargin, extent / share); };
    const CellBox piece = in_whole_blocks(with_margin(tiles, margin(tiles.width()), margin(tiles.height())));
    if (count_of(piece) <= kMostTiles) pieces.push_back(piece);
  }
  pieces.push_back(in_whole_blocks(tiles));
  return pieces;
}

std::uint64_t count_in(TileSet tiles) { return static_cast<std::uint64_t>(std::popcount(tiles)); }
TileSet bit_of(std::size_t tile) { return static_cast<TileSet>(1U << tile % kBlockTiles); }
bool holds(const CellBox& all, const CellBox& part) { return hull_of(all, part) == all; }

}  // namespace

bool FieldStrips::can_hold(const CellBox& box) const {
  if (std::min(box.min.x, box.min.y) < -kFurthestCell || std::max(box.end.x, box.end.y) > kFurthestCell) return false;
  if (shelf_) return true;
  const CellBox tiles = in_whole_blocks(tiles_that_hold(box));
  return count_of(tiles) <= kMostTiles && std::max(tiles.width(), tiles.height()) <= kMostTilesOfASide;
}

std::string FieldStrips::limit() const {
  return ", more than 2^32 of which are not counted; check the log with 'gdtslam doctor' or raise map.resolution";
}

void FieldStrips::hold(const CellBox& wanted, const GridBoxes& boxes) {
  assert(can_hold(boxes.content));
  if (shelf_) {
    come_near(wanted);
  } else if (const CellBox tiles = tiles_that_hold(boxes.content); !holds(tiles_, tiles)) {
    make_piece(tiles);
  }
  box_ = boxes.stored;
}

// What is known already lies in the piece; with the next piece, or for want of memory, it goes to the shelf as the
// rest.
void FieldStrips::keep_near(const std::string& folder) {
  if (!shelf_) shelf_.emplace(folder);
}

void FieldStrips::come_near(const CellBox& box) {
  if (!shelf_ || !can_hold(box)) return;
  if (const CellBox tiles = tiles_that_hold(box); !holds(near_, tiles)) {
    const CellBox near = with_margin(tiles, kNearMargin, kNearMargin);
    if (count_of(in_whole_blocks(near)) > kMostTiles) {
      throw InputError("a scan reaches over " + size_of(box) +
                       ", more than 2^32 of which are not counted; does the laser sit so far from the robot's centre "
                       "(log.mount), or is map.resolution too small?");
    }
    if (!holds(tiles_, near)) make_piece(near);
    take_near(near);
    near_ = near;
  }
  if (here_ > kMostHere) put_far_away(with_margin(near_, kFarMargin, kFarMargin));
}

// One that holds the tiles; blocks that are outside of it go to the shelf, where there is one.
void FieldStrips::make_piece(const CellBox& tiles) {
  const std::vector<CellBox> pieces = pieces_for(tiles);
  for (const CellBox& piece : pieces) {
    const bool is_last = piece == pieces.back();
    Buffer buffer = is_last ? backend_->allocate(bytes_of(piece)) : backend_->reserve(bytes_of(piece));
    if (!buffer.valid()) continue;
    move_to(piece, std::move(buffer));
    return;
  }
}

std::span<std::uint16_t, kBlockCells> FieldStrips::cells_of(std::size_t block) const {
  return std::span<std::uint16_t, kBlockCells>(memory_.subspan(block * kBlockCells, kBlockCells));
}

BlockIndex FieldStrips::index_of(std::size_t block) const {
  const auto rows = static_cast<std::size_t>(tiles_.height() / kBlockTiles);
  return {tiles_.min.x + static_cast<std::int32_t>(block / rows),
          tiles_.min.y / kBlockTiles + static_cast<std::int32_t>(block % rows)};
}

CellBox FieldStrips::tiles_of(std::size_t block) const {
  const BlockIndex index = index_of(block);
  const CellIndex first{index.x, index.y * kBlockTiles};
  return {first, first + CellOffset{1, kBlockTiles}};
}

// Takes the tiles along that are known, each of which is one stretch of memory, and their repeated cells.
void FieldStrips::move_to(const CellBox& tiles, Buffer buffer) {
  const std::span<std::byte> view = backend_->host_view(buffer);
  // The bytes are written as uint16 by the kernels, aligned by the backend.
  const std::span<std::uint16_t> memory{reinterpret_cast<std::uint16_t*>(view.data()),
                                        view.size() / sizeof(std::uint16_t)};
  const auto rows = static_cast<std::size_t>(tiles.height() / kBlockTiles);
  std::vector<TileSet> known(static_cast<std::size_t>(tiles.width()) * rows);
  for (std::size_t block = 0; block < known_.size(); ++block) {
    if (known_[block] != 0 && !holds(tiles, tiles_of(block))) put_away(block);
  }
  for (std::size_t block = 0; block < known_.size(); ++block) {
    if (known_[block] == 0) continue;
    const CellIndex first = tiles_of(block).min;
    const std::size_t to = static_cast<std::size_t>(first.x - tiles.min.x) * rows +
                           static_cast<std::size_t>(first.y - tiles.min.y) / kBlockTiles;
    known[to] = known_[block];
    const std::span<std::uint16_t, kBlockCells> from = cells_of(block);
    for (std::size_t tile = 0; tile < kBlockTiles; ++tile) {
      if ((known_[block] & bit_of(tile)) == 0) continue;
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(tile * kTileOfStripCells), kTileOfStripCells,
                  memory.begin() + static_cast<std::ptrdiff_t>(to * kBlockCells + tile * kTileOfStripCells));
    }
    forget(std::as_writable_bytes(from));
  }
  tiles_ = tiles;
  known_ = std::move(known);
  next_ = 0;
  stored_ = {{tiles.min.x * kSide, tiles.min.y * kSide}, {tiles.end.x * kSide, tiles.end.y * kSide}};
  layout_.stride = kStripStride;
  layout_.strip = static_cast<std::uint32_t>(rows * kBlockCells);
  memory_ = memory;
  buffer_ = std::move(buffer);
  for (std::size_t block = 0; block < known_.size(); ++block) repeat_first_cells(block);
}

// The first cells of the block's known tiles stand behind those of the strip to its left, too.
void FieldStrips::repeat_first_cells(std::size_t block) {
  if (known_[block] == 0 || block * kBlockCells < layout_.strip) return;
  for (std::size_t tile = 0; tile < kBlockTiles; ++tile) {
    if ((known_[block] & bit_of(tile)) == 0) continue;
    const std::size_t first = block * kBlockCells + tile * kTileOfStripCells;
    for (std::size_t cell = first; cell < first + kTileOfStripCells; cell += kStripStride) {
      memory_[cell - layout_.strip + kStripWidth] = memory_[cell];
    }
  }
}

// What waits of those tiles comes back.
void FieldStrips::take_near(const CellBox& tiles) {
  if (shelf_->empty()) return;
  std::vector<std::size_t> blocks;
  const CellBox whole = in_whole_blocks(tiles);
  for (std::int32_t x = whole.min.x; x < whole.end.x; ++x) {
    for (std::int32_t y = whole.min.y; y < whole.end.y; y += kBlockTiles) {
      const std::size_t block = tile_of({x, y}) / kBlockTiles;
      const TileSet taken = shelf_->take(index_of(block), cells_of(block));
      if (taken == 0) continue;
      assert(known_[block] == 0);
      known_[block] = taken;
      here_ += count_in(taken);
      blocks.push_back(block);
    }
  }
  const auto rows = static_cast<std::size_t>(tiles_.height() / kBlockTiles);
  for (const std::size_t block : blocks) {
    repeat_first_cells(block);
    if (block + rows < known_.size()) repeat_first_cells(block + rows);
  }
}

void FieldStrips::put_away(std::size_t block) {
  const std::span<std::uint16_t, kBlockCells> cells = cells_of(block);
  shelf_->put(index_of(block), known_[block], cells);
  here_ -= count_in(known_[block]);
  known_[block] = 0;
  forget(std::as_writable_bytes(cells));
}

// Some blocks that are outside of the tiles, round by round.
void FieldStrips::put_far_away(const CellBox& tiles) {
  std::size_t left = kMostPutAway;
  for (std::size_t k = std::min(kMostPassedOver, known_.size()); k > 0 && left > 0; --k) {
    const std::size_t block = std::exchange(next_, (next_ + 1) % known_.size());
    if (known_[block] == 0) continue;
    if (!common_part(tiles, tiles_of(block)).empty()) continue;
    put_away(block);
    --left;
  }
}

std::size_t FieldStrips::tile_of(CellIndex tile) const {
  const CellOffset d = tile - tiles_.min;
  return static_cast<std::size_t>(d.dx) * static_cast<std::size_t>(tiles_.height()) + static_cast<std::size_t>(d.dy);
}

template <class See>
void FieldStrips::for_each_tile(const CellBox& box, See see) const {
  const CellBox tiles = tiles_that_hold(box);
  for (std::int32_t x = tiles.min.x; x < tiles.end.x; ++x) {
    for (std::int32_t y = tiles.min.y; y < tiles.end.y; ++y) see(tile_of({x, y}));
  }
}

void FieldStrips::touch(const CellBox& box) {
  for_each_tile(box, [this](std::size_t tile) {
    TileSet& known = known_[tile / kBlockTiles];
    const std::uint64_t more = (known & bit_of(tile)) == 0 ? 1U : 0U;
    here_ += more;
    taken_ += more;
    known |= bit_of(tile);
  });
}

std::uint64_t FieldStrips::untaken_cells(const CellBox& box) const {
  std::uint64_t cells = 0;
  for_each_tile(box, [&](std::size_t tile) {
    cells += (known_[tile / kBlockTiles] & bit_of(tile)) == 0 ? kStripWidth * kStripWidth : 0U;
  });
  return cells;
}

std::uint64_t FieldStrips::taken_cells() const { return taken_ * kStripWidth * kStripWidth; }

void FieldStrips::read_row(CellIndex first, std::span<std::uint16_t> cells, std::uint16_t cap) const {
  if (is_whole()) return FieldStore::read_row(first, cells, cap);
  std::array<std::uint16_t, kStripWidth> row{};
  for (std::size_t i = 0; i < cells.size();) {
    const CellIndex cell = first + CellOffset{static_cast<std::int32_t>(i), 0};
    const std::int32_t column = floor_to(cell.x, kSide);
    const auto begin = static_cast<std::size_t>(cell.x - column * kSide);
    const std::size_t count = std::min(kStripWidth - begin, cells.size() - i);
    const std::span<std::uint16_t> piece = cells.subspan(i, count);
    const BlockIndex block{column, floor_to(cell.y, kBlockRows)};
    const bool is_here = shelf_->tiles_of(block) == 0;
    if (is_here) {
      FieldStore::read_row(cell, piece, cap);
    } else {
      shelf_->read_row(block, static_cast<std::size_t>(cell.y - block.y * kBlockRows), row);
      std::transform(
          row.begin() + static_cast<std::ptrdiff_t>(begin), row.begin() + static_cast<std::ptrdiff_t>(begin + count),
          piece.begin(),
          [blank = layout_.blank](std::uint16_t value) { return static_cast<std::uint16_t>(value ^ blank); });
    }
    i += count;
  }
}

std::vector<std::uint16_t> FieldStrips::read() const {
  std::vector<std::uint16_t> cells;
  const auto width = static_cast<std::size_t>(box_.width());
  cells.resize(width * static_cast<std::size_t>(box_.height()));
  for (std::int32_t y = box_.min.y; y < box_.end.y; ++y) {
    const auto row = std::span(cells).subspan(static_cast<std::size_t>(y - box_.min.y) * width, width);
    read_row({box_.min.x, y}, row, static_cast<std::uint16_t>(layout_.blank));
  }
  return cells;
}

void FieldStrips::write(const CellRows& from) {
  assert(is_whole());
  for (std::size_t tile = 0; tile < known_.size() * kBlockTiles; ++tile) {
    if ((known_[tile / kBlockTiles] & bit_of(tile)) == 0) continue;
    const auto cells = memory_.subspan(tile * kTileOfStripCells, kTileOfStripCells);
    std::fill(cells.begin(), cells.end(), std::uint16_t{0});
    const std::size_t strip = layout_.strip;
    for (std::size_t row = 0; row < kStripWidth && tile * kTileOfStripCells >= strip; ++row) {
      memory_[tile * kTileOfStripCells - strip + row * kStripStride + kStripWidth] = 0;
    }
  }
  const CellBox box = common_part(from.box, stored_);
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x;) {
      const std::int32_t count = std::min((floor_to(x, kSide) + 1) * kSide, box.end.x) - x;
      const std::size_t place =
          static_cast<std::size_t>(y - from.box.min.y) * from.stride + static_cast<std::size_t>(x - from.box.min.x);
      write_piece({x, y}, from.cells.subspan(place, static_cast<std::size_t>(count)));
      x += count;
    }
  }
}

// Cells of one row within a strip. What is unknown takes no memory.
void FieldStrips::write_piece(CellIndex first, std::span<const std::uint16_t> cells) {
  const auto cap = static_cast<std::uint16_t>(layout_.blank);
  if (std::all_of(cells.begin(), cells.end(), [cap](std::uint16_t cell) { return cell == cap; })) return;
  touch({first, first + CellOffset{1, 1}});
  const CellOffset d = first - stored_.min;
  const std::size_t place = layout_.place(static_cast<std::size_t>(d.dx), static_cast<std::size_t>(d.dy));
  for (std::size_t i = 0; i < cells.size(); ++i) memory_[place + i] = static_cast<std::uint16_t>(cells[i] ^ cap);
  if (d.dx > 0 && d.dx % kSide == 0) memory_[place - layout_.strip + kStripWidth] = memory_[place];
}

Buffer FieldStrips::snapshot() const { throw std::logic_error("FieldStrips: a snapshot is for devices"); }

}  // namespace gdtslam
