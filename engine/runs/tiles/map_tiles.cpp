#include "map_tiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kPieceTiles = 8;  // tiles along a side of a piece, made together

std::int32_t floor_to(std::int32_t cell, std::int32_t side) { return (cell >= 0 ? cell : cell - (side - 1)) / side; }

CellBox hull(const CellBox& a, const CellBox& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.end.x, b.end.x), std::max(a.end.y, b.end.y)}};
}

bool touch(const CellBox& a, const CellBox& b) {
  return a.min.x < b.end.x && b.min.x < a.end.x && a.min.y < b.end.y && b.min.y < a.end.y;
}

// Tiles that the keyframe's beams, or the disc around an obstacle, may reach; sometimes a few more.
CellBox tiles_around(const RunKeyframe& keyframe, const MapperConfig& mapper, double free_m) {
  constexpr double kSlack_m = 0.1;
  double range_m = free_m;
  for (const float range : keyframe.laser.ranges_m) {
    if (static_cast<double>(range) < mapper.scan.max_range_m) range_m = std::max(range_m, static_cast<double>(range));
  }
  const LaserScan& scan = keyframe.laser;
  const auto laser_m = [&](std::size_t beam) {
    const Pose2 T_base_laser = is_skewed(scan) ? laser_at_beam(scan, beam) : scan.T_base_laser;
    return (keyframe.T_map_base * T_base_laser).translation();
  };
  const Point2 first_m = laser_m(0);
  const Point2 last_m = laser_m(scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1);
  const double reach_m = range_m + (last_m - first_m).norm() + mapper.map.truncation_m + kSlack_m;
  const Point2 around(reach_m, reach_m);
  const CellIndex low = map_cell_at(first_m - around, mapper.map.resolution_m);
  const CellIndex high = map_cell_at(first_m + around, mapper.map.resolution_m);
  return {{floor_to(low.x, kMapTileSide), floor_to(low.y, kMapTileSide)},
          {floor_to(high.x, kMapTileSide) + 1, floor_to(high.y, kMapTileSide) + 1}};
}

bool by_row(const CellIndex& a, const CellIndex& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); }

GridGeometry tile_geometry(const CellIndex& place, double resolution_m) {
  return {.resolution_m = resolution_m,
          .origin_x_m = std::int64_t{place.x} * kMapTileSide * resolution_m,
          .origin_y_m = std::int64_t{place.y} * kMapTileSide * resolution_m,
          .width = kMapTileSide,
          .height = kMapTileSide};
}

// Reads the part of the map in the tile; returns whether any cell is known.
bool read_states(const OccupancyMap& map, const CellIndex& first, CellStates& states) {
  const CellIndex corner{static_cast<std::int32_t>(std::lround(map.geometry.origin_x_m / map.geometry.resolution_m)),
                         static_cast<std::int32_t>(std::lround(map.geometry.origin_y_m / map.geometry.resolution_m))};
  states = CellStates(std::size_t{kMapTileSide} * kMapTileSide);
  bool is_known = false;
  const CellOffset d = first - corner;
  for (std::int32_t y = std::max(0, -d.dy); y < std::min(kMapTileSide, map.geometry.height - d.dy); ++y) {
    for (std::int32_t x = std::max(0, -d.dx); x < std::min(kMapTileSide, map.geometry.width - d.dx); ++x) {
      const CellState state = map.at({x + d.dx, y + d.dy});
      if (state == CellState::kUnknown) continue;
      states.set(static_cast<std::size_t>(y) * kMapTileSide + static_cast<std::size_t>(x), state);
      is_known = true;
    }
  }
  return is_known;
}

// Marks the cells in the tile.
void mark_states(const std::vector<ChangedCell>& cells, CellState state, const CellIndex& first, CellStates& states) {
  for (const ChangedCell& changed : cells) {
    const CellOffset d = changed.cell - first;
    if (d.dx < 0 || d.dy < 0 || d.dx >= kMapTileSide || d.dy >= kMapTileSide) continue;
    states.set(static_cast<std::size_t>(d.dy) * kMapTileSide + static_cast<std::size_t>(d.dx), state);
  }
}

// Reads the part of the distance field in the tile; returns whether any cell is known.
bool read_distances(const GlobalField& field, const CellIndex& first, std::vector<std::uint16_t>& distances) {
  distances.resize(std::size_t{kMapTileSide} * kMapTileSide);
  for (std::int32_t y = 0; y < kMapTileSide; ++y) {
    field.read_row(first + CellOffset{0, y},
                   std::span(distances).subspan(static_cast<std::size_t>(y) * kMapTileSide, kMapTileSide));
  }
  return std::any_of(distances.begin(), distances.end(), [cap = field.cap()](std::uint16_t d) { return d != cap; });
}

}  // namespace

TileMaker::TileMaker(const RunKeyframes& run, const MapperConfig& mapper, const OccupancyConfig& occupancy,
                     MapChanges changes, TileParts parts)
    : run_(&run), mapper_(mapper), occupancy_(occupancy), changes_(std::move(changes)), parts_(parts) {
  std::set<std::pair<std::int32_t, std::int32_t>> touched;
  reach_.reserve(run.keyframes.size());
  for (const RunKeyframe& keyframe : run.keyframes) {
    reach_.push_back(tiles_around(keyframe, mapper, occupancy.no_return_free_m));
    const CellBox& tiles = reach_.back();
    for (std::int32_t y = tiles.min.y; y < tiles.end.y; ++y) {
      for (std::int32_t x = tiles.min.x; x < tiles.end.x; ++x) touched.insert({y, x});
    }
  }
  for (const auto& [y, x] : touched) places_.push_back({x, y});
}

std::vector<std::size_t> TileMaker::keyframes_that_touch(const CellBox& tiles) const {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < reach_.size(); ++k) {
    if (touch(reach_[k], tiles)) found.push_back(k);
  }
  return found;
}

void TileMaker::make(std::span<const CellIndex> places, const std::function<void(MapTile&&)>& take,
                     const std::function<void(double)>& progress) const {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<CellIndex>> pieces;
  for (const CellIndex& place : places) {
    pieces[{floor_to(place.y, kPieceTiles), floor_to(place.x, kPieceTiles)}].push_back(place);
  }
  std::size_t done = 0;
  for (auto& [key, of_piece] : pieces) {
    std::sort(of_piece.begin(), of_piece.end(), by_row);
    CellBox tiles{of_piece.front(), of_piece.front() + CellOffset{1, 1}};
    for (const CellIndex& place : of_piece) tiles = hull(tiles, {place, place + CellOffset{1, 1}});
    make_piece(tiles, of_piece, take, [&](std::size_t made) {
      progress(static_cast<double>(done + made) / static_cast<double>(places.size()));
    });
    done += of_piece.size();
  }
}

OccupancyMap TileMaker::cast(std::span<const std::size_t> keyframes, const std::function<void()>& between) const {
  constexpr std::size_t kBetween = 64;
  OccupancyBuilder builder(occupancy_, occupancy_limits(mapper_));
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (i % kBetween == 0) between();
    const RunKeyframe& keyframe = run_->keyframes[keyframes[i]];
    builder.add(keyframe.laser, keyframe.T_map_base);
  }
  return builder.build();
}

// States of a tile with the changes between the drives of the site; `is_known` is by the states before the changes.
CellStates TileMaker::states_at(const CellIndex& first, const OccupancyMap& piece, bool& is_known) const {
  CellStates states;
  is_known = read_states(piece, first, states);
  mark_states(changes_.gone, CellState::kFree, first, states);
  mark_states(changes_.appeared, CellState::kOccupied, first, states);
  return states;
}

// Merges and casts whole scans; cells outside of the piece are dropped.
void TileMaker::make_piece(const CellBox& tiles, std::span<const CellIndex> places,
                           const std::function<void(MapTile&&)>& take,
                           const std::function<void(std::size_t made)>& before) const {
  const std::vector<std::size_t> touching = keyframes_that_touch(tiles);
  if (touching.empty()) return;
  const OccupancyMap occupancy = cast(touching, [&] { before(0); });  // which also decides where tiles exist
  const std::unique_ptr<SeparateMap> map = map_of_keyframes(*run_, touching, mapper_);
  for (std::size_t k = 0; k < places.size(); ++k) {
    before(k);
    const CellIndex& place = places[k];
    MapTile tile{.place = place,
                 .keyframes = keyframes_that_touch({place, place + CellOffset{1, 1}}).size(),
                 .distances = {},
                 .cap = map->field().cap(),
                 .occupancy = {tile_geometry(place, mapper_.map.resolution_m), {}}};
    const CellIndex first{place.x * kMapTileSide, place.y * kMapTileSide};
    bool has_states = false;
    CellStates states = states_at(first, occupancy, has_states);
    if (has_occupancy()) tile.occupancy.cells = std::move(states);
    const bool has_distances = read_distances(map->field(), first, tile.distances);
    if (has_states || has_distances) take(std::move(tile));
  }
}

namespace {

constexpr int kTilesVersion = 1;
constexpr std::size_t kMostIndexBytes = std::size_t{64} << 20U;

std::string tile_path(const std::string& folder, const char* what, CellIndex place) {
  return fmt::format("{}/{}_{}_{}.yaml", folder, what, place.x, place.y);
}

CellBox tile_hull(std::span<const CellIndex> places) {
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

/// All tiles in one small map: a cell stands for a square of tile cells. It is occupied if any of them is, else free if
/// any is. At most 8192 cells a side.
class TileOverview {
 public:
  TileOverview(std::span<const CellIndex> places, double resolution_m) : tiles_(tile_hull(places)) {
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
    const std::int32_t cells = kMapTileSide / scale_;  // cells of a tile, along a side
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
  write_distance_field(tile_path(folder, "gdt", tile.place), rows);
  if (tile.occupancy.cells.size() > 0) {
    write_occupancy_map(tile_path(folder, "map", tile.place), tile.occupancy, MapImage::kPng);
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
  } catch (const Error&) {  // a foreign folder
    return false;
  }
}

std::string sha256_of(const TileIndex& index) {
  Sha256 hash;
  for (const TileRecord& tile : index.tiles) hash.update(tile.place.x).update(tile.place.y).update(tile.sha256);
  return hash.hex();
}

GridGeometry tiles_geometry(const TileIndex& index) {
  std::vector<CellIndex> places;
  for (const TileRecord& tile : index.tiles) places.push_back(tile.place);
  return geometry_of_tiles(tile_hull(places), index.resolution_m);
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
