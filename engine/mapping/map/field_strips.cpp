#include "field_strips.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

#include "growth.hpp"

namespace gdtslam {
namespace {

constexpr auto kSide = static_cast<std::int32_t>(kStripWidth);  // of a tile, cells
constexpr std::size_t kCellsOfTile = std::size_t{kStripStride} * kStripWidth;
// As many as 32 bits count the cells of, and as the kernels take along a side.
constexpr std::int64_t kMostTiles = (std::int64_t{1} << 32U) / static_cast<std::int64_t>(kCellsOfTile);
constexpr std::int32_t kMostTilesOfASide = (1 << 21) / kSide - 1;
// A piece of address space is a square of so many tiles a side, where the process may have 8 GB of it.
constexpr std::int32_t kWideSide = 960;
constexpr std::int32_t kLeastMargin = 16;  // tiles

std::int32_t floor_to_tile(std::int32_t cell) { return (cell >= 0 ? cell : cell - (kSide - 1)) / kSide; }

CellBox tiles_that_hold(const CellBox& box) {
  return {{floor_to_tile(box.min.x), floor_to_tile(box.min.y)},
          {floor_to_tile(box.end.x - 1) + 1, floor_to_tile(box.end.y - 1) + 1}};
}

std::int64_t count_of(const CellBox& tiles) { return std::int64_t{tiles.width()} * tiles.height(); }
std::size_t bytes_of(const CellBox& tiles) {
  return static_cast<std::size_t>(count_of(tiles)) * kCellsOfTile * sizeof(std::uint16_t);
}

CellBox with_margin(const CellBox& tiles, std::int32_t x, std::int32_t y) {
  return {tiles.min - CellOffset{x, y}, tiles.end + CellOffset{x, y}};
}

// Pieces of address space that hold the tiles, from the one that is wanted most to the least one.
std::vector<CellBox> pieces_for(const CellBox& tiles) {
  std::vector<CellBox> pieces;
  if (tiles.width() <= kWideSide && tiles.height() <= kWideSide) {
    pieces.push_back(with_margin(tiles, (kWideSide - tiles.width()) / 2, (kWideSide - tiles.height()) / 2));
  }
  for (std::int32_t share = 2; share <= 32; share *= 4) {
    const auto margin = [share](std::int32_t extent) { return std::max(kLeastMargin, extent / share); };
    const CellBox piece = with_margin(tiles, margin(tiles.width()), margin(tiles.height()));
    if (count_of(piece) <= kMostTiles) pieces.push_back(piece);
  }
  pieces.push_back(tiles);
  return pieces;
}

}  // namespace

bool FieldStrips::can_hold(const CellBox& box) const {
  if (std::min(box.min.x, box.min.y) < -kFurthestCell || std::max(box.end.x, box.end.y) > kFurthestCell) return false;
  const CellBox tiles = tiles_that_hold(box);
  return count_of(tiles) <= kMostTiles && std::max(tiles.width(), tiles.height()) <= kMostTilesOfASide;
}

std::string FieldStrips::limit() const {
  return ", more than 2^32 of which are not counted; check the log with 'gdtslam doctor' or raise map.resolution";
}

void FieldStrips::hold(const CellBox& content, const CellBox& box) {
  assert(can_hold(content));
  const CellBox tiles = tiles_that_hold(content);
  if (hull_of(tiles_, tiles) != tiles_) {
    const std::vector<CellBox> pieces = pieces_for(tiles);
    for (const CellBox& piece : pieces) {
      const bool is_last = piece == pieces.back();
      Buffer buffer = is_last ? backend_->allocate(bytes_of(piece)) : backend_->reserve(bytes_of(piece));
      if (!buffer.valid()) continue;
      move_to(piece, std::move(buffer));
      break;
    }
  }
  box_ = box;
}

// Takes the tiles along that are known, each of which is one stretch of memory, and their repeated cells.
void FieldStrips::move_to(const CellBox& tiles, Buffer buffer) {
  const std::span<std::byte> view = backend_->host_view(buffer);
  // The bytes are written as uint16 by the kernels, aligned by the backend.
  const std::span<std::uint16_t> memory{reinterpret_cast<std::uint16_t*>(view.data()),
                                        view.size() / sizeof(std::uint16_t)};
  const auto strip = static_cast<std::size_t>(tiles.height()) * kCellsOfTile;
  const CellOffset shift = tiles_.min - tiles.min;
  std::vector<bool> is_known(static_cast<std::size_t>(count_of(tiles)));
  for (std::size_t tile = 0; tile < is_known_.size(); ++tile) {
    if (!is_known_[tile]) continue;
    const auto rows = static_cast<std::size_t>(tiles_.height());
    const std::size_t x = tile / rows + static_cast<std::size_t>(shift.dx);
    const std::size_t y = tile % rows + static_cast<std::size_t>(shift.dy);
    is_known[x * static_cast<std::size_t>(tiles.height()) + y] = true;
    const std::span<const std::uint16_t> from = std::span<const std::uint16_t>(memory_).subspan(tile * kCellsOfTile);
    std::copy_n(from.begin(), kCellsOfTile, memory.begin() + static_cast<std::ptrdiff_t>(x * strip + y * kCellsOfTile));
    if (x == 0) continue;
    for (std::size_t row = 0; row < kStripWidth; ++row) {
      memory[(x - 1) * strip + y * kCellsOfTile + row * kStripStride + kStripWidth] = from[row * kStripStride];
    }
  }
  tiles_ = tiles;
  is_known_ = std::move(is_known);
  stored_ = {{tiles.min.x * kSide, tiles.min.y * kSide}, {tiles.end.x * kSide, tiles.end.y * kSide}};
  layout_.stride = kStripStride;
  layout_.strip = static_cast<std::uint32_t>(strip);
  memory_ = memory;
  buffer_ = std::move(buffer);
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
    known_ += is_known_[tile] ? 0U : 1U;
    is_known_[tile] = true;
  });
}

std::uint64_t FieldStrips::untaken_cells(const CellBox& box) const {
  std::uint64_t cells = 0;
  for_each_tile(box, [&](std::size_t tile) { cells += is_known_[tile] ? 0U : kStripWidth * kStripWidth; });
  return cells;
}

std::uint64_t FieldStrips::taken_cells() const { return known_ * kStripWidth * kStripWidth; }

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
  for (std::size_t tile = 0; tile < is_known_.size(); ++tile) {
    if (!is_known_[tile]) continue;
    const auto cells = memory_.subspan(tile * kCellsOfTile, kCellsOfTile);
    std::fill(cells.begin(), cells.end(), std::uint16_t{0});
    const std::size_t strip = layout_.strip;
    for (std::size_t row = 0; row < kStripWidth && tile * kCellsOfTile >= strip; ++row) {
      memory_[tile * kCellsOfTile - strip + row * kStripStride + kStripWidth] = 0;
    }
  }
  const CellBox box = common_part(from.box, stored_);
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x;) {
      const std::int32_t count = std::min((floor_to_tile(x) + 1) * kSide, box.end.x) - x;
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
