#include "tile_folder.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "tile_overview.hpp"

namespace gdtslam {
namespace {

constexpr int kTilesVersion = 1;
constexpr std::size_t kMostIndexBytes = std::size_t{64} << 20U;
constexpr const char* kTilesAgain = "; make the tiles again: gdtslam tiles RUN";
constexpr std::int32_t kFurthestTile = (1 << 19) - 1;  // from end to end no more cells than an int32 counts
constexpr double kCoarsestTiles_m = 1.0;               // as of a map

std::string file_of(const std::string& folder, const char* what, CellIndex place) {
  return fmt::format("{}/{}_{}.yaml", folder, what, name_of_tile(place));
}

bool is_whole_number(std::string_view text) {
  if (text.starts_with("-")) text.remove_prefix(1);
  return is_digits(text);
}

/// The index as somebody may have edited it.
class IndexReader {
 public:
  IndexReader(std::string file, const nlohmann::ordered_json& json) : file_(std::move(file)), json_(&json) {}

  [[nodiscard]] std::int64_t whole(const char* key, std::int64_t least, std::int64_t most) const {
    const auto found = json_->find(key);
    if (found == json_->end() || !found->is_number_integer()) fail(key);
    const bool is_far = found->is_number_unsigned() && found->get<std::uint64_t>() > static_cast<std::uint64_t>(most);
    const auto value = found->get<std::int64_t>();
    if (is_far || value < least || value > most) fail(key);
    return value;
  }
  [[nodiscard]] double positive(const char* key, double most) const {
    const auto found = json_->find(key);
    if (found == json_->end() || !found->is_number()) fail(key);
    const auto value = found->get<double>();
    if (!(value > 0.0 && value <= most)) fail(key);
    return value;
  }
  [[nodiscard]] std::string hash(const char* key) const {
    const auto found = json_->find(key);
    if (found == json_->end() || !found->is_string()) fail(key);
    return found->get<std::string>();
  }
  /// True where it is not told, as in older ones.
  [[nodiscard]] bool flag(const char* key) const {
    const auto found = json_->find(key);
    if (found == json_->end()) return true;
    if (!found->is_boolean()) fail(key);
    return found->get<bool>();
  }
  [[noreturn]] void fail(const char* key) const {
    throw InputError({file_, 0}, fmt::format("has no '{}' that is one{}", key, kTilesAgain));
  }

 private:
  std::string file_;
  const nlohmann::ordered_json* json_;
};

}  // namespace

std::string name_of_tile(CellIndex place) { return fmt::format("{}_{}", place.x, place.y); }

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

bool is_tile_file(std::string_view name) {
  if (name == kTileIndex || (name.starts_with(".") && name.ends_with(".tmp"))) return true;
  if (!name.starts_with("gdt_") && !name.starts_with("map_")) return false;
  for (const std::string_view ending : {".yaml", ".png"}) {
    if (!name.ends_with(ending)) continue;
    const std::string_view place = name.substr(4, name.size() - 4 - ending.size());
    const std::size_t between = place.find('_');
    return between != std::string_view::npos && is_whole_number(place.substr(0, between)) &&
           is_whole_number(place.substr(between + 1));
  }
  return false;
}

bool is_tile_folder(const std::string& folder) {
  const std::string file = folder + "/" + kTileIndex;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  try {
    const nlohmann::ordered_json json = read_json(file, kMostIndexBytes, kTilesAgain);
    return json.is_object() && json.contains("format") && json.contains("tile_cells");
  } catch (const InputError&) {  // of somebody else
    return false;
  }
}

std::string foreign_among_tiles(const std::string& folder) {
  namespace fs = std::filesystem;
  std::string first;
  std::error_code ignored;
  for (const fs::path& file : list_folder(folder, ignored)) {
    std::string name = file.filename().string();
    const bool is_tile = is_tile_file(name) && !fs::is_directory(fs::symlink_status(file, ignored));
    if (!is_tile && (first.empty() || name < first)) first = std::move(name);
  }
  return first;
}

TileIndex read_tile_index(const std::string& folder) {
  const std::string file = folder + "/" + kTileIndex;
  std::error_code ignored;  // what cannot be asked about cannot be read either
  if (!std::filesystem::exists(file, ignored)) {
    throw InputError({folder, 0}, std::string("holds no tiles, for it has no index.json") + kTilesAgain);
  }
  const nlohmann::ordered_json json = read_json(file, kMostIndexBytes, kTilesAgain);
  if (!json.is_object()) throw InputError({file, 0}, std::string("is no index of tiles") + kTilesAgain);
  const IndexReader reader(file, json);
  if (reader.whole("format", 0, std::numeric_limits<std::int32_t>::max()) != kTilesVersion ||
      reader.whole("tile_cells", 1, std::numeric_limits<std::int32_t>::max()) != kMapTileSide) {
    throw InputError({file, 0}, std::string("is of another version") + kTilesAgain);
  }
  TileIndex index{
      reader.hash("keyframes_sha256"), reader.positive("resolution_m", kCoarsestTiles_m), reader.flag("occupancy"), {}};
  const auto tiles = json.find("tiles");
  if (tiles == json.end() || !tiles->is_array()) reader.fail("tiles");
  for (const nlohmann::ordered_json& entry : *tiles) {
    if (!entry.is_object()) reader.fail("tiles");
    const IndexReader tile(file, entry);
    const CellIndex place{static_cast<std::int32_t>(tile.whole("x", -kFurthestTile, kFurthestTile)),
                          static_cast<std::int32_t>(tile.whole("y", -kFurthestTile, kFurthestTile))};
    index.tiles.push_back(
        {place, static_cast<std::size_t>(tile.whole("keyframes", 0, std::int64_t{1} << 40U)), tile.hash("gdt_sha256")});
    for (const char* what : {"gdt", "map"}) {
      if (what == std::string_view("map") && !index.has_occupancy) continue;
      const std::string part = file_of(folder, what, place);
      if (!std::filesystem::exists(part, ignored)) {
        throw InputError({part, 0}, std::string("is missing, and index.json names it") + kTilesAgain);
      }
    }
  }
  return index;
}

std::string sha256_of(const TileIndex& index) {
  Sha256 hash;
  for (const TileRecord& tile : index.tiles) hash.update(tile.place.x).update(tile.place.y).update(tile.sha256);
  return hash.hex();
}

GridGeometry geometry_of(const TileIndex& index) {
  CellBox tiles{};
  for (const TileRecord& tile : index.tiles) {
    const CellBox one{tile.place, tile.place + CellOffset{1, 1}};
    tiles = tiles.empty() ? one
                          : CellBox{{std::min(tiles.min.x, one.min.x), std::min(tiles.min.y, one.min.y)},
                                    {std::max(tiles.end.x, one.end.x), std::max(tiles.end.y, one.end.y)}};
  }
  return {.resolution_m = index.resolution_m,
          .origin_x_m = std::int64_t{tiles.min.x} * kMapTileSide * index.resolution_m,
          .origin_y_m = std::int64_t{tiles.min.y} * kMapTileSide * index.resolution_m,
          .width = tiles.width() * kMapTileSide,
          .height = tiles.height() * kMapTileSide};
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
