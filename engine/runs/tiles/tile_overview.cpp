#include "tile_overview.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace gdtslam {
namespace {

constexpr std::int64_t kMostOverviewCells = 8192;  // along a side

}  // namespace

TileOverview::TileOverview(std::span<const CellIndex> places, double resolution_m)
    : tiles_{places.front(), places.front() + CellOffset{1, 1}} {
  for (const CellIndex& place : places) {
    tiles_.min = {std::min(tiles_.min.x, place.x), std::min(tiles_.min.y, place.y)};
    tiles_.end = {std::max(tiles_.end.x, place.x + 1), std::max(tiles_.end.y, place.y + 1)};
  }
  const std::int64_t side = std::int64_t{std::max(tiles_.width(), tiles_.height())} * kMapTileSide;
  while (side / scale_ > kMostOverviewCells && scale_ < kMapTileSide) scale_ *= 2;
  const std::int32_t of_tile = kMapTileSide / scale_;
  map_.geometry = {.resolution_m = resolution_m * scale_,
                   .origin_x_m = static_cast<double>(std::int64_t{tiles_.min.x} * kMapTileSide) * resolution_m,
                   .origin_y_m = static_cast<double>(std::int64_t{tiles_.min.y} * kMapTileSide) * resolution_m,
                   .width = tiles_.width() * of_tile,
                   .height = tiles_.height() * of_tile};
  map_.cells = CellStates(map_.geometry.cell_count());
}

void TileOverview::add(const MapTile& tile) {
  const std::int32_t of_tile = kMapTileSide / scale_;
  const CellOffset corner{(tile.place.x - tiles_.min.x) * of_tile, (tile.place.y - tiles_.min.y) * of_tile};
  std::array<CellState, kMapTileSide> row{};
  for (std::int32_t y = 0; y < kMapTileSide; ++y) {
    tile.occupancy.read_row(y, row);
    const auto first =
        static_cast<std::size_t>(corner.dy + y / scale_) * static_cast<std::size_t>(map_.geometry.width) +
        static_cast<std::size_t>(corner.dx);
    for (std::int32_t x = 0; x < of_tile; ++x) {
      const auto begin = row.begin() + std::ptrdiff_t{x} * scale_;
      const CellState state = *std::max_element(begin, begin + scale_);
      const std::size_t cell = first + static_cast<std::size_t>(x);
      if (state > map_.cells[cell]) map_.cells.set(cell, state);
    }
  }
}

}  // namespace gdtslam
