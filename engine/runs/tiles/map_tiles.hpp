// A map in tiles, for sites that are too large for one piece: squares of 2048 cells, 51.2 m of 25 mm, each with its
// part of the distance field and, on request, of the occupancy map. A tile is made only from the keyframes that touch
// it, merged in their order, because the merge depends on it. So a tile has the same cells whether it is made alone or
// with all others. For a merged site, the changes between its drives are marked as in the site's own map. Frame: map;
// the corner of tile (0, 0) is the map's origin. Thread-safe; a keyframe costs about a millisecond for each piece of 8
// x 8 tiles that it touches; memory for one such piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

inline constexpr std::int32_t kMapTileSide = 2048;  ///< cells

struct MapTile {
  CellIndex place;                       ///< column and row
  std::size_t keyframes = 0;             ///< that may touch it
  std::vector<std::uint16_t> distances;  ///< 1/256 cell, row by row from the lower left cell; the cap if unknown
  std::uint16_t cap = 0;
  OccupancyMap occupancy;  ///< cells in the same order; empty without occupancy
};

enum class TileParts : std::uint8_t { kBoth, kDistances };

class TileMaker {
 public:
  /// Keyframes must outlive it; configurations are those of their run. Changes are those after all drives, in cells
  /// counted from the map's origin.
  TileMaker(const RunKeyframes& run, const MapperConfig& mapper, const OccupancyConfig& occupancy,
            MapChanges changes = {}, TileParts parts = TileParts::kBoth);

  /// Tiles that a keyframe may touch, row by row from the lowest.
  [[nodiscard]] const std::vector<CellIndex>& places() const { return places_; }
  [[nodiscard]] bool has_occupancy() const { return parts_ == TileParts::kBoth; }
  /// Makes the tiles at those places, except unknown ones. Calls progress() with the share done before each tile and
  /// each 64 cast keyframes. Throws InputError if a piece of the map would exceed map.max_megacells, and exceptions of
  /// take() and progress().
  void make(std::span<const CellIndex> places, const std::function<void(MapTile&&)>& take,
            const std::function<void(double)>& progress) const;

 private:
  [[nodiscard]] std::vector<std::size_t> keyframes_that_touch(const CellBox& tiles) const;
  void make_piece(const CellBox& tiles, std::span<const CellIndex> places, const std::function<void(MapTile&&)>& take,
                  const std::function<void(std::size_t made)>& before) const;
  [[nodiscard]] OccupancyMap cast(std::span<const std::size_t> keyframes, const std::function<void()>& between) const;
  [[nodiscard]] CellStates states_at(const CellIndex& first, const OccupancyMap& piece, bool& is_known) const;

  const RunKeyframes* run_;
  MapperConfig mapper_;
  OccupancyConfig occupancy_;
  MapChanges changes_;
  TileParts parts_;
  std::vector<CellBox> reach_;  // reach of each keyframe, in tiles
  std::vector<CellIndex> places_;
};

// The tiles of a map as files: for each tile gdt_X_Y.png and, with an occupancy map, map_X_Y.png, with descriptions, as
// maps that `gdtslam localize` and map_server read. index.json lists all tiles (docs/formats.md). It is written last,
// and a folder without it has no tiles. Thread-safe; O(cells).

inline constexpr const char* kTileFolder = "tiles";  ///< in the folder of a run
inline constexpr const char* kTileIndex = "index.json";

struct TileRecord {
  CellIndex place;
  std::size_t keyframes = 0;  ///< that may touch it
  std::string sha256;         ///< hash of its part of the distance field
};
struct TileIndex {
  std::string keyframes_sha256;  ///< hash of the keyframes of the tiles
  double resolution_m = 0.0;
  bool has_occupancy = true;
  std::vector<TileRecord> tiles;  ///< row by row from the lowest
};

/// True if the folder holds tiles and their index, and nothing else.
bool is_tile_folder(const std::string& folder);
/// Hash of all cells of all tiles.
std::string sha256_of(const TileIndex& index);
/// The grid around all tiles.
GridGeometry tiles_geometry(const TileIndex& index);

/// Result of making tiles.
struct MadeTiles {
  TileIndex index;
  OccupancyMap overview;  ///< small map of all tiles, with cells of 2, 4, 8 ... tile cells: occupied if any is; empty
                          ///< without occupancy
};
/// Makes the tiles of all keyframes in an existing folder. Throws like TileMaker::make(); FileError.
MadeTiles write_tiles(const std::string& folder, const TileMaker& maker, const std::string& keyframes_sha256,
                      double resolution_m, const std::function<void(double)>& progress);

}  // namespace gdtslam
