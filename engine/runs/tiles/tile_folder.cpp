#include "tile_folder.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"

namespace gdtslam {
namespace {

constexpr int kTilesVersion = 1;
constexpr std::size_t kMostIndexBytes = std::size_t{64} << 20U;

std::string file_of(const std::string& folder, const char* what, CellIndex place) {
  return fmt::format("{}/{}_{}_{}.yaml", folder, what, place.x, place.y);
}

CellBox hull_of(std::span<const CellIndex> places) {
  CellBox hull{places.front(), places.front() + CellOffset{1, 1}};
  for (const CellIndex& place : places) {
    hull.min = {std::min(hull.min.x, place.x), std::min(hull.min.y, place.y)};
    hull.end = {std::max(hull.end.x, place.x + 1), std::max(hull.end.y, place.y + 1)};
  }
  return hull;
}

GridGeometry geometry_of_tiles(const CellBox& tiles, double resolution_m) {
  return {.resolution_m = resolution_m,
          .origin_x_m = std::int64_t{tiles.min.x} * kMapTileSide * resolution_m,
          .origin_y_m = std::int64_t{tiles.min.y} * kMapTileSide * resolution_m,
          .width = tiles.width() * kMapTileSide,
          .height = tiles.height() * kMapTileSide};
}

/// All tiles in one small map: a cell stands for a square of theirs, and is occupied where any of them is, else free
/// where any is. At most 8192 cells a side.
class TileOverview {
 public:
  TileOverview(std::span<const CellIndex> places, double resolution_m) : tiles_(hull_of(places)) {
    constexpr std::int64_t kMostOverviewCells = 8192;
    const std::int64_t side = std::int64_t{std::max(tiles_.width(), tiles_.height())} * kMapTileSide;
    while (side / scale_ > kMostOverviewCells && scale_ < kMapTileSide) scale_ *= 2;
    map_.geometry = geometry_of_tiles(tiles_, resolution_m);
    map_.geometry.resolution_m *= scale_;
    map_.geometry.width /= scale_;
    map_.geometry.height /= scale_;
    map_.cells = CellStates(map_.geometry.cell_count());
  }
  void add(const MapTile& tile) {
    const std::int32_t cells = kMapTileSide / scale_;  // of a tile, along a side
    const CellOffset corner{(tile.place.x - tiles_.min.x) * cells, (tile.place.y - tiles_.min.y) * cells};
    std::array<CellState, kMapTileSide> row{};
    for (std::int32_t y = 0; y < kMapTileSide; ++y) {
      tile.occupancy.read_row(y, row);
      const auto first =
          static_cast<std::size_t>(corner.dy + y / scale_) * static_cast<std::size_t>(map_.geometry.width) +
          static_cast<std::size_t>(corner.dx);
      for (std::int32_t x = 0; x < cells; ++x) {
        const auto begin = row.begin() + std::ptrdiff_t{x} * scale_;
        const CellState state = *std::max_element(begin, begin + scale_);
        const std::size_t cell = first + static_cast<std::size_t>(x);
        if (state > map_.cells[cell]) map_.cells.set(cell, state);
      }
    }
  }
  [[nodiscard]] OccupancyMap take() { return std::move(map_); }

 private:
  CellBox tiles_;
  std::int32_t scale_ = 1;  // a power of two
  OccupancyMap map_;
};

TileRecord write_tile(const std::string& folder, const MapTile& tile) {
  const DistanceFieldRows rows =
      rows_of(DistanceFieldView{tile.occupancy.geometry, std::size_t{kMapTileSide}, tile.distances, tile.cap});
  write_distance_field(file_of(folder, "gdt", tile.place), rows);
  if (tile.occupancy.cells.size() > 0) {
    write_occupancy_map(file_of(folder, "map", tile.place), tile.occupancy, MapImage::kPng);
  }
  return {tile.place, tile.keyframes, sha256_of(rows)};
}

void write_tile_index(const std::string& folder, const TileIndex& index) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  json["format"] = kTilesVersion;
  json["version"] = GDTSLAM_VERSION;
  json["keyframes_sha256"] = index.keyframes_sha256;
  json["resolution_m"] = index.resolution_m;
  json["tile_cells"] = kMapTileSide;
  json["occupancy"] = index.has_occupancy;
  json["tiles"] = nlohmann::ordered_json::array();
  for (const TileRecord& tile : index.tiles) {
    json["tiles"].push_back(
        {{"x", tile.place.x}, {"y", tile.place.y}, {"keyframes", tile.keyframes}, {"gdt_sha256", tile.sha256}});
  }
  write_json(folder + "/" + kTileIndex, json);
}

bool is_tile_file(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, ignored))) return false;
  if (name == kTileIndex) return true;
  return (name.starts_with("gdt_") || name.starts_with("map_")) && (name.ends_with(".yaml") || name.ends_with(".png"));
}

}  // namespace

bool is_tile_folder(const std::string& folder) {
  std::error_code failed;
  const std::vector<std::filesystem::path> files = list_folder(folder, failed);
  if (failed || !std::all_of(files.begin(), files.end(), is_tile_file)) return false;
  try {
    return read_json(folder + "/" + kTileIndex, kMostIndexBytes).contains("tile_cells");
  } catch (const Error&) {  // a folder of somebody else
    return false;
  }
}

std::string sha256_of(const TileIndex& index) {
  Sha256 hash;
  for (const TileRecord& tile : index.tiles) hash.update(tile.place.x).update(tile.place.y).update(tile.sha256);
  return hash.hex();
}

GridGeometry geometry_of(const TileIndex& index) {
  std::vector<CellIndex> places;
  for (const TileRecord& tile : index.tiles) places.push_back(tile.place);
  return geometry_of_tiles(hull_of(places), index.resolution_m);
}

MadeTiles write_tiles(const std::string& folder, const TileMaker& maker, const std::string& keyframes_sha256,
                      double resolution_m, const std::function<void(double)>& progress) {
  MadeTiles made{{keyframes_sha256, resolution_m, maker.has_occupancy(), {}}, {}};
  if (maker.places().empty()) throw InputError("no keyframe sees anything, so there is no tile to make");
  std::optional<TileOverview> overview;
  if (maker.has_occupancy()) overview.emplace(maker.places(), resolution_m);
  maker.make(
      maker.places(),
      [&](MapTile&& tile) {
        made.index.tiles.push_back(write_tile(folder, tile));
        if (overview) overview->add(tile);
      },
      progress);
  std::sort(made.index.tiles.begin(), made.index.tiles.end(), [](const TileRecord& a, const TileRecord& b) {
    return std::pair(a.place.y, a.place.x) < std::pair(b.place.y, b.place.x);
  });
  write_tile_index(folder, made.index);
  if (overview) made.overview = overview->take();
  return made;
}

}  // namespace gdtslam
