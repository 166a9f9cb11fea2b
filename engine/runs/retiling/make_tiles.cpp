#include "make_tiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/changes_of_keyframes.hpp"
#include "engine/runs/transaction/folder_transaction.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

void require_own(const std::string& place) {
  std::error_code ignored;  // what cannot be asked about shows when it cannot be replaced
  if (!fs::exists(place, ignored)) return;
  if (is_tile_folder(place) && foreign_among_tiles(place).empty()) return;
  throw UsageError(place + " holds what is no tile: move it away, for tiles are written there");
}

TileIndex index_with(const std::string& place, const std::string& keyframes_sha256) {
  TileIndex index = read_tile_index(place);
  if (index.keyframes_sha256 == keyframes_sha256) return index;
  throw InputError({place, 0}, "holds tiles of other keyframes than the run has now; make all of them again");
}

void require_tiles(const std::vector<CellIndex>& only, const TileIndex& index, const std::string& place) {
  for (const CellIndex& tile : only) {
    const bool is_there = std::any_of(index.tiles.begin(), index.tiles.end(),
                                      [&](const TileRecord& record) { return record.place == tile; });
    if (is_there) continue;
    throw UsageError(fmt::format("--only: the run has no tile {},{}; {}/{} names those that there are", tile.x, tile.y,
                                 place, kTileIndex));
  }
}

// The old tiles get their names in the new folder too, where what is made again takes them.
void bring_along(const FolderTransaction& fresh, const std::function<void()>& before_piece) {
  std::error_code failed;
  for (const fs::path& file : list_folder(fresh.target(), failed)) {
    const fs::path there = fresh.staging() / file.filename();
    std::error_code without_links;  // as some file systems are
    fs::create_hard_link(file, there, without_links);
    if (without_links) copy_file_atomically(file.string(), there.string(), before_piece);
  }
  if (failed) throw FileError(fresh.target().string(), "cannot be listed: " + failed.message());
}

// Makes some tiles again; the others stay.
void make_some(const std::vector<CellIndex>& only, const TileMaker& maker, const FolderTransaction& fresh,
               const std::function<void(double)>& progress, TilesOutcome& outcome) {
  bring_along(fresh, [&progress] { progress(0.0); });
  maker.make(
      only,
      [&](MapTile&& tile) {
        const TileRecord made = write_tile(fresh.staging().string(), tile);
        const auto record = std::find_if(outcome.index.tiles.begin(), outcome.index.tiles.end(),
                                         [&](const TileRecord& r) { return r.place == made.place; });
        if (record->sha256 != made.sha256) outcome.changed.push_back(made.place);
        *record = made;
        ++outcome.made;
      },
      progress);
  write_tile_index(fresh.staging().string(), outcome.index);
}

RunKeyframes kept_keyframes_of(const RunReader& reader) {
  if (std::optional<RunKeyframes> kept = reader.keyframes()) return *std::move(kept);
  throw InputError({reader.folder(), 0},
                   reader.summary().nods
                       ? "is a run of a laser that nods; only flat lasers' maps are kept in tiles"
                       : "has no keyframes.bin.gz, which older versions did not write: map its log again");
}

MapChanges changes_in(const RunReader& reader, const RunKeyframes& kept, const MapperConfig& config) {
  const std::vector<std::size_t>& drives = reader.summary().drives;
  if (drives.empty()) return {};
  const Trajectory trajectory = reader.trajectory();
  return changes_after_all({kept.keyframes, trajectory, drives}, config);
}

}  // namespace

TilesOutcome make_tiles(const TilesRequest& request) {
  const RunReader reader(request.run);
  const RunKeyframes kept = kept_keyframes_of(reader);
  const Settings settings = reader.settings();
  const MapperConfig& config = settings.mapper;
  const auto progress = [&request](double share) {
    if (request.stop && request.stop()) throw Error(ExitCode::kInterrupted, "interrupted; the tiles are as before");
    if (request.progress) request.progress(share);
  };
  const std::string& hash = *reader.summary().keyframes_sha256;
  TilesOutcome outcome{(fs::path(request.run) / kTileFolder).string(), {}, 0, {}};
  if (request.only.empty()) {
    require_own(outcome.folder);
  } else {
    outcome.index = index_with(outcome.folder, hash);
    require_tiles(request.only, outcome.index, outcome.folder);
  }
  progress(0.0);
  const TileParts parts = outcome.index.has_occupancy ? TileParts::kBoth : TileParts::kDistances;
  const TileMaker maker(kept, config, settings.occupancy, changes_in(reader, kept, config), parts);
  FolderTransaction fresh(outcome.folder);
  if (request.only.empty()) {
    outcome.index = write_tiles(fresh.staging().string(), maker, hash, config.map.resolution_m, progress).index;
    outcome.made = outcome.index.tiles.size();
  } else {
    make_some(request.only, maker, fresh, progress, outcome);
  }
  reader.files().expect_unchanged();
  if (request.only.empty()) require_own(outcome.folder);
  fresh.commit();
  return outcome;
}

}  // namespace gdtslam
