// The tiles of a map as files: for each one gdt_X_Y.png and, with an occupancy map, map_X_Y.png with their
// descriptions, maps in themselves that `gdtslam localize` and map_server read, and index.json, which names them all
// (docs/formats.md). The index is written last, and a folder without it holds no tiles. Thread-safe; O(cells).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tile_maker.hpp"

namespace gdtslam {

inline constexpr const char* kTileFolder = "tiles";  ///< in the folder of a run
inline constexpr const char* kTileIndex = "index.json";

struct TileRecord {
  CellIndex place;
  std::size_t keyframes = 0;  ///< that may touch it
  std::string sha256;         ///< of its part of the distance field
};
struct TileIndex {
  std::string keyframes_sha256;  ///< of the run that they were made of
  double resolution_m = 0.0;
  bool has_occupancy = true;
  std::vector<TileRecord> tiles;  ///< row by row from the lowest
};

/// Whether the folder holds tiles and their index, and nothing else.
bool is_tile_folder(const std::string& folder);
/// Of all cells of all tiles.
std::string sha256_of(const TileIndex& index);
/// Around all tiles.
GridGeometry geometry_of(const TileIndex& index);

/// What making tiles came to.
struct MadeTiles {
  TileIndex index;
  OccupancyMap overview;  ///< of all tiles, in cells of 2, 4, 8 ... of theirs: occupied where any is; or of none
};
/// Makes the tiles of all keyframes in a folder that exists. Throws what TileMaker::make() throws; FileError.
MadeTiles write_tiles(const std::string& folder, const TileMaker& maker, const std::string& keyframes_sha256,
                      double resolution_m, const std::function<void(double)>& progress);

}  // namespace gdtslam
