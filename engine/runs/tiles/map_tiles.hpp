// A map in tiles, for sites that are too large for one piece: squares of 2048 cells, 51.2 m of 25 mm, each with its
// part of the distance field and, where it is asked for, of the occupancy map. A tile is made from the keyframes that
// touch it alone, merged in their order, for the merge depends on it; so it has the same cells whether it is made by
// itself or with all others. Of a merged site what changed between its drives is marked besides, as in the site's own
// map. Frame: map; the corner of tile (0, 0) is the map's origin. Thread-safe; a keyframe costs about a millisecond for
// each piece of 8 x 8 tiles that it touches, and memory is that of one such piece.
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
  CellIndex place;                       ///< its column and row
  std::size_t keyframes = 0;             ///< that may touch it
  std::vector<std::uint16_t> distances;  ///< 1/256 cell, row by row from the lower left cell; the cap where unknown
  std::uint16_t cap = 0;
  OccupancyMap occupancy;  ///< cells in the same order; none if no occupancy is asked for
};

enum class TileParts : std::uint8_t { kBoth, kDistances };

class TileMaker {
 public:
  /// Keyframes must outlive it; configurations are those of their run, and changes those after all of its drives, in
  /// cells that count from the map's origin.
  TileMaker(const RunKeyframes& run, const MapperConfig& mapper, const OccupancyConfig& occupancy,
            MapChanges changes = {}, TileParts parts = TileParts::kBoth);

  /// Tiles that a keyframe may touch, row by row from the lowest.
  [[nodiscard]] const std::vector<CellIndex>& places() const { return places_; }
  [[nodiscard]] bool has_occupancy() const { return parts_ == TileParts::kBoth; }
  /// Makes the tiles of those places that anything is known of. Throws InputError where a piece of the map would be
  /// beyond map.max_megacells; what take() and progress() throw, the latter with the share that is done, before each
  /// tile and each 64 keyframes that are cast.
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

// The tiles of a map as files: for each one gdt_X_Y.png and, with an occupancy map, map_X_Y.png with their
// descriptions, maps in themselves that `gdtslam localize` and map_server read, and index.json, which names them all
// (docs/formats.md). The index is written last, and a folder without it holds no tiles. Thread-safe; O(cells).

inline constexpr const char* kTileFolder = "tiles";  ///< in the folder of a run
inline constexpr const char* kTileIndex = "index.json";

struct TileRecord {
  CellIndex place;
  std::size_t keyframes = 0;  ///< that may touch it
  std::string sha256;         ///< hash of its part of the distance field
};
struct TileIndex {
  std::string keyframes_sha256;  ///< hash of the keyframes that they were made of
  double resolution_m = 0.0;
  bool has_occupancy = true;
  std::vector<TileRecord> tiles;  ///< row by row from the lowest
};

/// Whether the folder holds tiles and their index, and nothing else.
bool is_tile_folder(const std::string& folder);
/// Hash of all cells of all tiles.
std::string sha256_of(const TileIndex& index);
/// Around all tiles.
GridGeometry tiles_geometry(const TileIndex& index);

/// Result of making tiles.
struct MadeTiles {
  TileIndex index;
  OccupancyMap overview;  ///< small map of all tiles, in cells of 2, 4, 8 ... of theirs: occupied if any is; empty
                          ///< without occupancy
};
/// Makes the tiles of all keyframes in a folder that exists. Throws what TileMaker::make() throws; FileError.
MadeTiles write_tiles(const std::string& folder, const TileMaker& maker, const std::string& keyframes_sha256,
                      double resolution_m, const std::function<void(double)>& progress);

}  // namespace gdtslam
