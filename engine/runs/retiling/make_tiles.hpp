// The tiles of a run that has been mapped: what `gdtslam tiles` does. One call belongs to one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/runs/tiles/tile_folder.hpp"

namespace gdtslam {

struct TilesRequest {
  std::string run;              ///< folder of `map`, `merge` or `edit`
  std::vector<CellIndex> only;  ///< those that are made again, the others stay; empty: all
  std::function<void(double)> progress;
  std::function<bool()> stop;  ///< asked before each tile and each 64 keyframes that are cast
};

struct TilesOutcome {
  std::string folder;
  TileIndex index;
  std::size_t made = 0;
  std::vector<CellIndex> changed;  ///< with `only`: of those the ones whose distances are others than before
};

/// Makes them from the run's keyframes in its folder `tiles`, all that are asked for or none of them: a folder that
/// holds them already is replaced at the end. Throws UsageError where the run has no such tile as one of `only`;
/// InputError where the run has no keyframes, or its tiles are of other keyframes and only some are to be made;
/// Error(kInterrupted), FileError.
TilesOutcome make_tiles(const TilesRequest& request);

}  // namespace gdtslam
