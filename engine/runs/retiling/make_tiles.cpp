#include "make_tiles.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/runs/folder/folder_lock.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

/// A folder beside the tiles in which new ones are made; gone with the object unless it took their place.
class NewTiles {
 public:
  explicit NewTiles(const std::string& run)
      : place_(fs::path(run) / kTileFolder), folder_(fs::path(run) / fmt::format(".gdtslam-tiles-{}", ::getpid())) {
    std::error_code failed;
    remove_tree(folder_, failed);
    if (!fs::create_directory(folder_, failed)) throw FileError(run, "cannot be written to: " + failed.message());
  }
  NewTiles(const NewTiles&) = delete;
  NewTiles& operator=(const NewTiles&) = delete;
  ~NewTiles() {
    without_throwing([this] {
      std::error_code ignored;
      remove_tree(folder_, ignored);
    });
  }
  [[nodiscard]] std::string folder() const { return folder_.string(); }
  [[nodiscard]] std::string place() const { return place_.string(); }
  // The old ones go once the new ones have their name.
  void take_place() const {
    const fs::path old = folder_.string() + "-old";
    std::error_code failed;
    if (fs::exists(place_)) fs::rename(place_, old, failed);
    if (!failed) fs::rename(folder_, place_, failed);
    if (failed) throw FileError(place(), "cannot be replaced: " + failed.message());
    remove_tree(old, failed);
  }

 private:
  fs::path place_;
  fs::path folder_;
};

void require_own(const std::string& place) {
  std::error_code ignored;  // what cannot be asked about shows when it cannot be replaced
  if (!fs::exists(place, ignored) || is_tile_folder(place)) return;
  throw UsageError(place + " holds no tiles: move it away, for tiles are written there");
}

TileIndex index_with(const std::string& place, const std::string& keyframes_sha256) {
  TileIndex index = read_tile_index(place);
  if (index.keyframes_sha256 == keyframes_sha256) return index;
  throw InputError({place, 0}, "holds tiles of other keyframes than the run has now; make all of them again");
}

// Makes some tiles again among those that are there.
TilesOutcome make_some(const TilesRequest& request, const TileMaker& maker, TileIndex index, const std::string& place,
                       const std::function<void(double)>& progress) {
  TilesOutcome outcome{place, std::move(index), 0, {}};
  std::vector<TileRecord*> records;
  for (const CellIndex& tile : request.only) {
    const auto found = std::find_if(outcome.index.tiles.begin(), outcome.index.tiles.end(),
                                    [&](const TileRecord& record) { return record.place == tile; });
    if (found == outcome.index.tiles.end()) {
      throw UsageError(fmt::format("--only: the run has no tile {},{}; {}/{} names those that there are", tile.x,
                                   tile.y, place, kTileIndex));
    }
  }
  maker.make(
      request.only,
      [&](MapTile&& tile) {
        const TileRecord made = write_tile(place, tile);
        const auto record = std::find_if(outcome.index.tiles.begin(), outcome.index.tiles.end(),
                                         [&](const TileRecord& r) { return r.place == made.place; });
        if (record->sha256 != made.sha256) outcome.changed.push_back(made.place);
        *record = made;
        ++outcome.made;
      },
      progress);
  write_tile_index(place, outcome.index);
  return outcome;
}

}  // namespace

TilesOutcome make_tiles(const TilesRequest& request) {
  const RunReader reader(request.run);
  const std::optional<RunKeyframes> kept = reader.keyframes();
  if (!kept) {
    throw InputError({request.run, 0}, reader.summary().nods
                                           ? "is a run of a laser that nods; only flat lasers' maps are kept in tiles"
                                           : "has no keyframes.bin.gz, which older versions did not write: map its log "
                                             "again");
  }
  const Settings settings = reader.settings();
  const TileMaker maker(*kept, settings.mapper, settings.occupancy);
  const auto progress = [&request](double share) {
    if (request.stop && request.stop()) throw Error(ExitCode::kInterrupted, "interrupted; the tiles are as before");
    if (request.progress) request.progress(share);
  };
  const std::string& hash = *reader.summary().keyframes_sha256;
  const std::string place = request.run + "/" + kTileFolder;
  const FolderLock lock(request.run);
  if (!request.only.empty()) return make_some(request, maker, index_with(place, hash), place, progress);
  require_own(place);
  const NewTiles fresh(request.run);
  MadeTiles made = write_tiles(fresh.folder(), maker, hash, settings.mapper.map.resolution_m, progress);
  fresh.take_place();
  const std::size_t count = made.index.tiles.size();
  return {fresh.place(), std::move(made.index), count, {}};
}

}  // namespace gdtslam
