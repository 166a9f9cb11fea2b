#include "field_store.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/core/memory/page_memory.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// The cells of a map on the CPU, in strips of 64 columns (kernel.hpp) within a piece of address space larger than the
/// map: the system provides pages at the first access, filled with zero, which means unknown. If a map outgrows its
/// piece, or the process has too little address space, the known tiles move to a larger one.
class FieldStrips final : public FieldStore {
 public:
  FieldStrips(Backend& backend, std::uint16_t cap) : backend_(&backend) { layout_.blank = cap; }

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override;
  void hold(const GridBoxes& boxes) override;
  void touch(const CellBox& box) override;
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& box) const override;
  [[nodiscard]] bool may_know(CellIndex cell) const override;
  [[nodiscard]] std::uint64_t taken_cells() const override;
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;

 private:
  void make_piece(const CellBox& tiles);
  void move_to(const CellBox& tiles, Buffer buffer);
  void repeat_first_cells(std::size_t tile);
  [[nodiscard]] std::size_t tile_index(CellIndex tile) const;
  template <class See>
  void for_each_tile(const CellBox& box, See see) const;
  void write_piece(CellIndex first, std::span<const std::uint16_t> cells);

  Backend* backend_;
  CellBox box_{};
  CellBox tiles_{};          // tiles of 64 x 64 cells that the piece of address space holds
  std::vector<bool> known_;  // one entry a tile, strip by strip
  std::uint64_t taken_ = 0;  // bytes in use
};

constexpr auto kSide = static_cast<std::int32_t>(kStripWidth);  // side of a tile, cells
constexpr std::size_t kTileOfStripCells = std::size_t{kStripStride} * kStripWidth;
// Limit of tiles: 32 bits count their cells, and a side fits the kernels.
constexpr std::int64_t kMostTiles = (std::int64_t{1} << 32U) / static_cast<std::int64_t>(kTileOfStripCells);
constexpr std::int32_t kMostTilesOfASide = (1 << 21) / kSide - 1;
// Tiles along the side of a square piece of address space, if the process may have 8 GB of it.
constexpr std::int32_t kWideSide = 960;
constexpr std::int32_t kLeastMargin = 16;  // tiles

std::int32_t floor_to(std::int32_t cell, std::int32_t side) { return (cell >= 0 ? cell : cell - (side - 1)) / side; }

CellBox tiles_that_hold(const CellBox& box) {
  return {{floor_to(box.min.x, kSide), floor_to(box.min.y, kSide)},
          {floor_to(box.end.x - 1, kSide) + 1, floor_to(box.end.y - 1, kSide) + 1}};
}

std::int64_t tile_count(const CellBox& tiles) { return std::int64_t{tiles.width()} * tiles.height(); }
std::size_t byte_count(const CellBox& tiles) {
  return static_cast<std::size_t>(tile_count(tiles)) * kTileOfStripCells * sizeof(std::uint16_t);
}

CellBox with_margin(const CellBox& tiles, std::int32_t x, std::int32_t y) {
  return {tiles.min - CellOffset{x, y}, tiles.end + CellOffset{x, y}};
}

// Pieces of address space that hold the tiles, the most wanted first.
std::vector<CellBox> pieces_for(const CellBox& tiles) {
  std::vector<CellBox> pieces;
  if (tiles.width() <= kWideSide && tiles.height() <= kWideSide) {
    pieces.push_back(with_margin(tiles, (kWideSide - tiles.width()) / 2, (kWideSide - tiles.height()) / 2));
  }
  for (std::int32_t share = 2; share <= 32; share *= 4) {
    const auto margin = [share](std::int32_t extent) { return std::max(kLeastMargin, extent / share); };
    const CellBox piece = with_margin(tiles, margin(tiles.width()), margin(tiles.height()));
    if (tile_count(piece) <= kMostTiles) pieces.push_back(piece);
  }
  pieces.push_back(tiles);
  return pieces;
}

bool FieldStrips::can_hold(const CellBox& box) const {
  if (std::min(box.min.x, box.min.y) < -kFurthestCell || std::max(box.end.x, box.end.y) > kFurthestCell) return false;
  const CellBox tiles = tiles_that_hold(box);
  return tile_count(tiles) <= kMostTiles && std::max(tiles.width(), tiles.height()) <= kMostTilesOfASide;
}

std::string FieldStrips::limit() const {
  return ", more than 2^32 of which are not counted; check the log with 'gdtslam doctor' or raise map.resolution";
}

void FieldStrips::hold(const GridBoxes& boxes) {
  assert(can_hold(boxes.content));
  const CellBox tiles = tiles_that_hold(boxes.content);
  if (bounding_box(tiles_, tiles) != tiles_) make_piece(tiles);
  box_ = boxes.stored;
}

// Makes a piece that holds the tiles.
void FieldStrips::make_piece(const CellBox& tiles) {
  const std::vector<CellBox> pieces = pieces_for(tiles);
  for (const CellBox& piece : pieces) {
    const bool is_last = piece == pieces.back();
    Buffer buffer = is_last ? backend_->allocate(byte_count(piece)) : backend_->reserve(byte_count(piece));
    if (!buffer.valid()) continue;
    move_to(piece, std::move(buffer));
    return;
  }
}

// Moves the known tiles, each of which is contiguous in memory, and their repeated cells.
void FieldStrips::move_to(const CellBox& tiles, Buffer buffer) {
  const std::span<std::byte> view = backend_->host_view(buffer);
  // The bytes are written as uint16 by the kernels, aligned by the backend.
  const std::span<std::uint16_t> memory{reinterpret_cast<std::uint16_t*>(view.data()),
                                        view.size() / sizeof(std::uint16_t)};
  std::vector<bool> known(static_cast<std::size_t>(tile_count(tiles)));
  const std::span<std::uint16_t> before = memory_;
  const CellBox from = std::exchange(tiles_, tiles);
  const auto rows = static_cast<std::size_t>(from.height());
  std::vector<std::size_t> moved;
  for (std::size_t tile = 0; tile < known_.size(); ++tile) {
    if (known_[tile]) {
      const std::size_t to = tile_index(
          from.min + CellOffset{static_cast<std::int32_t>(tile / rows), static_cast<std::int32_t>(tile % rows)});
      known[to] = true;
      moved.push_back(to);
      const auto cells = before.subspan(tile * kTileOfStripCells, kTileOfStripCells);
      std::copy(cells.begin(), cells.end(), memory.begin() + static_cast<std::ptrdiff_t>(to * kTileOfStripCells));
    }
    const bool is_last_of_strip = (tile + 1) % rows == 0;
    if (is_last_of_strip) {
      forget(std::as_writable_bytes(before.subspan((tile + 1 - rows) * kTileOfStripCells, rows * kTileOfStripCells)));
    }
  }
  known_ = std::move(known);
  stored_ = {{tiles.min.x * kSide, tiles.min.y * kSide}, {tiles.end.x * kSide, tiles.end.y * kSide}};
  layout_.stride = kStripStride;
  layout_.strip = static_cast<std::uint32_t>(static_cast<std::size_t>(tiles.height()) * kTileOfStripCells);
  memory_ = memory;
  buffer_ = std::move(buffer);
  for (const std::size_t tile : moved) repeat_first_cells(tile);
}

// The first cells of a tile are repeated behind those of the strip to its left.
void FieldStrips::repeat_first_cells(std::size_t tile) {
  const std::size_t first = tile * kTileOfStripCells;
  if (first < layout_.strip) return;
  for (std::size_t cell = first; cell < first + kTileOfStripCells; cell += kStripStride) {
    memory_[cell - layout_.strip + kStripWidth] = memory_[cell];
  }
}

std::size_t FieldStrips::tile_index(CellIndex tile) const {
  const CellOffset d = tile - tiles_.min;
  return static_cast<std::size_t>(d.dx) * static_cast<std::size_t>(tiles_.height()) + static_cast<std::size_t>(d.dy);
}

template <class See>
void FieldStrips::for_each_tile(const CellBox& box, See see) const {
  const CellBox tiles = tiles_that_hold(box);
  for (std::int32_t x = tiles.min.x; x < tiles.end.x; ++x) {
    for (std::int32_t y = tiles.min.y; y < tiles.end.y; ++y) see(tile_index({x, y}));
  }
}

void FieldStrips::touch(const CellBox& box) {
  for_each_tile(box, [this](std::size_t tile) {
    taken_ += known_[tile] ? 0U : 1U;
    known_[tile] = true;
  });
}

std::uint64_t FieldStrips::untaken_cells(const CellBox& box) const {
  std::uint64_t cells = 0;
  for_each_tile(box, [&](std::size_t tile) { cells += known_[tile] ? 0U : kStripWidth * kStripWidth; });
  return cells;
}

bool FieldStrips::may_know(CellIndex cell) const {
  return known_[tile_index({floor_to(cell.x, kSide), floor_to(cell.y, kSide)})];
}

std::uint64_t FieldStrips::taken_cells() const { return taken_ * kStripWidth * kStripWidth; }

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
  for (std::size_t tile = 0; tile < known_.size(); ++tile) {
    if (!known_[tile]) continue;
    const auto cells = memory_.subspan(tile * kTileOfStripCells, kTileOfStripCells);
    std::fill(cells.begin(), cells.end(), std::uint16_t{0});
    repeat_first_cells(tile);
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

// Writes cells of one row within a strip. Unknown cells take no memory.
void FieldStrips::write_piece(CellIndex first, std::span<const std::uint16_t> cells) {
  const auto cap = static_cast<std::uint16_t>(layout_.blank);
  if (std::all_of(cells.begin(), cells.end(), [cap](std::uint16_t cell) { return cell == cap; })) return;
  touch({first, first + CellOffset{1, 1}});
  const CellOffset d = first - stored_.min;
  const std::size_t place = layout_.place(static_cast<std::size_t>(d.dx), static_cast<std::size_t>(d.dy));
  for (std::size_t i = 0; i < cells.size(); ++i) memory_[place + i] = static_cast<std::uint16_t>(cells[i] ^ cap);
  if (d.dx > 0 && d.dx % kSide == 0) memory_[place - layout_.strip + kStripWidth] = memory_[place];
}

/// The cells of a map on a device, in rows of one rectangle; growing copies it there.
class FieldRows final : public FieldStore {
 public:
  FieldRows(Backend& backend, std::uint16_t cap, std::uint64_t max_cells)
      : backend_(&backend), cap_(cap), max_cells_(max_cells) {}

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override { return limit_of_option(max_cells_); }
  void hold(const GridBoxes& boxes) override;
  void touch(const CellBox& /*box*/) override {}
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& /*box*/) const override { return 0; }
  [[nodiscard]] bool may_know(CellIndex /*cell*/) const override { return true; }
  [[nodiscard]] std::uint64_t taken_cells() const override;
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;

 private:
  [[nodiscard]] Buffer allocate_for(const CellBox& box) const;
  void copy_into(const Buffer& target, const CellBox& box) const;

  Backend* backend_;
  std::uint16_t cap_;
  std::uint64_t max_cells_;
};

/// Cells from row to row of a box that is stored in rows.
std::uint32_t row_stride(const CellBox& box) { return grid_stride(static_cast<std::uint32_t>(box.width())); }

std::uint64_t cells_in_rows(const CellBox& box) {
  return std::uint64_t{row_stride(box)} * static_cast<std::uint64_t>(box.height());
}

// Copies cells into the layout of another box; the cap outside the first box.
std::vector<std::uint16_t> moved_cells(const CellRows& from, const CellBox& to, std::size_t stride, std::uint16_t cap) {
  std::vector<std::uint16_t> moved(stride * static_cast<std::size_t>(to.height()), cap);
  const CellBox kept = common_part(from.box, to);
  for (std::int32_t y = kept.min.y; y < kept.end.y && !kept.empty(); ++y) {
    const auto place = [&kept, y](const CellBox& box, std::size_t row) {
      return static_cast<std::size_t>(y - box.min.y) * row + static_cast<std::size_t>(kept.min.x - box.min.x);
    };
    std::copy_n(from.cells.data() + place(from.box, from.stride), kept.width(), moved.data() + place(to, stride));
  }
  return moved;
}

bool FieldRows::can_hold(const CellBox& box) const {
  return std::min(box.min.x, box.min.y) >= -kFurthestCell && std::max(box.end.x, box.end.y) <= kFurthestCell &&
         cells_in_rows(box) <= max_cells_;
}

// If the map has outgrown the device, the error says so and names the option to change.
Buffer FieldRows::allocate_for(const CellBox& box) const {
  const std::size_t bytes = cells_in_rows(box) * sizeof(std::uint16_t);
  try {
    return backend_->allocate(bytes);
  } catch (const DeviceError& error) {
    const DeviceInfo& device = backend_->device();
    if (bytes <= device.max_buffer_bytes) throw;
    throw DeviceError(
        device.name, error.call(),
        error.result() + ", for the map of " + size_text(box) + "; a larger map.resolution makes it smaller");
  }
}

void FieldRows::hold(const GridBoxes& boxes) {
  const CellBox& box = boxes.stored;
  if (box == stored_) return;
  Buffer buffer = allocate_for(box);
  if (stored_.empty()) {
    backend_->fill(buffer, std::uint32_t{cap_} << 16U | cap_);
  } else if (bounding_box(box, stored_) == box) {
    copy_into(buffer, box);
  } else {
    // A margin was given up, which happens a few times at most: copies through the host.
    const std::vector<std::uint16_t> cells = read();
    const CellRows from{cells, static_cast<std::size_t>(stored_.width()), stored_};
    const std::vector<std::uint16_t> moved = moved_cells(from, box, row_stride(box), cap_);
    backend_->upload(buffer, std::as_bytes(std::span(moved)));
  }
  buffer_ = std::move(buffer);
  stored_ = box;
  layout_.stride = row_stride(box);
}

// Copies the field into a buffer for a box that holds all of it.
void FieldRows::copy_into(const Buffer& target, const CellBox& box) const {
  const CellOffset offset = stored_.min - box.min;
  const auto width = static_cast<std::uint32_t>(box.width());
  const auto height = static_cast<std::uint32_t>(box.height());
  run<FieldGrow>(*backend_,
                 {.old_width = static_cast<std::uint32_t>(stored_.width()),
                  .old_height = static_cast<std::uint32_t>(stored_.height()),
                  .old_stride = layout_.stride,
                  .width = width,
                  .height = height,
                  .stride = row_stride(box),
                  .offset_x = static_cast<std::uint32_t>(offset.dx),
                  .offset_y = static_cast<std::uint32_t>(offset.dy),
                  .cap = cap_},
                 {width, height, 1}, buffer_, target);
}

std::uint64_t FieldRows::taken_cells() const { return stored_.empty() ? 0 : cells_in_rows(stored_); }

std::vector<std::uint16_t> FieldRows::read() const {
  std::vector<std::uint16_t> cells(taken_cells());
  if (cells.empty()) return cells;
  backend_->download(buffer_, std::as_writable_bytes(std::span(cells)));
  return moved_cells({cells, layout_.stride, stored_}, stored_, static_cast<std::size_t>(stored_.width()), cap_);
}

void FieldRows::write(const CellRows& from) {
  const std::vector<std::uint16_t> moved = moved_cells(from, stored_, layout_.stride, cap_);
  backend_->upload(buffer_, std::as_bytes(std::span(moved)));
}

}  // namespace

void FieldStore::read_row(CellIndex first, std::span<std::uint16_t> all, std::uint16_t cap) const {
  std::fill(all.begin(), all.end(), cap);
  const CellBox row{first, first + CellOffset{static_cast<std::int32_t>(all.size()), 1}};
  const CellBox part = common_part(row, stored_);
  if (part.empty()) return;
  assert(!memory_.empty());
  const auto cells =
      all.subspan(static_cast<std::size_t>(part.min.x - first.x), static_cast<std::size_t>(part.width()));
  const CellOffset d = part.min - stored_.min;
  auto x = static_cast<std::size_t>(d.dx);
  for (std::size_t i = 0; i < cells.size();) {
    const std::size_t count = std::min(kStripWidth - x % kStripWidth, cells.size() - i);
    const std::size_t first_of_piece = std::exchange(i, i + count);
    const std::size_t column = std::exchange(x, x + count);
    if (!may_know(part.min + CellOffset{static_cast<std::int32_t>(first_of_piece), 0})) continue;
    const auto piece = memory_.subspan(layout_.place(column, static_cast<std::size_t>(d.dy)), count);
    std::transform(piece.begin(), piece.end(), cells.begin() + static_cast<std::ptrdiff_t>(first_of_piece),
                   [blank = layout_.blank](std::uint16_t cell) { return static_cast<std::uint16_t>(cell ^ blank); });
  }
}

std::string limit_of_option(std::uint64_t max_cells) {
  return ", more than map.max_megacells allows (" + std::to_string(max_cells >> 20U) +
         " x 2^20); check the log with 'gdtslam doctor' or raise the limit";
}

std::unique_ptr<FieldStore> make_field_store(Backend& backend, std::uint16_t cap, std::uint64_t max_cells) {
  if (backend.device().kind == "cpu") return std::make_unique<FieldStrips>(backend, cap);
  return std::make_unique<FieldRows>(backend, cap, max_cells);
}

}  // namespace gdtslam
