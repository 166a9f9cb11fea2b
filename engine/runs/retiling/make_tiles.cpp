#include "make_tiles.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/runs/folder/folder_lock.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/changes_of_keyframes.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNewPrefix = ".gdtslam-tiles-";
constexpr std::string_view kOldSuffix = "-old";

bool is_old_tile(const fs::path& file) {
  std::error_code ignored;
  return is_tile_file(file.filename().string()) && !fs::is_directory(fs::symlink_status(file, ignored));
}

// Files among old tiles that are none move to the new ones. False where one cannot: then the old ones stay.
bool carry_over_foreign(const fs::path& old, const fs::path& place) {
  std::error_code failed;
  bool is_done = true;
  for (const fs::path& file : list_folder(old, failed)) {
    const std::string name = file.filename().string();
    if (is_old_tile(file)) continue;
    std::error_code kept;
    if (!lies_there(place / name)) fs::rename(file, place / name, kept);
    is_done = is_done && !kept;
  }
  return is_done && !failed;
}

/// What processes left that were killed as they made tiles of the run.
struct LeftTiles {
  std::vector<fs::path> unfinished;
  std::vector<fs::path> old;  ///< tiles that were away while new ones took their place
};

LeftTiles left_tiles_in(const std::string& run) {
  LeftTiles left;
  std::error_code ignored;  // what cannot be listed is not in the way
  for (const fs::path& path : list_folder(run, ignored)) {
    const std::string name = path.filename().string();
    if (!name.starts_with(kNewPrefix)) continue;
    std::string_view process = std::string_view(name).substr(kNewPrefix.size());
    const bool is_old = process.ends_with(kOldSuffix);
    if (is_old) process.remove_suffix(kOldSuffix.size());
    if (!is_digits(process)) continue;
    (is_old ? left.old : left.unfinished).push_back(path);
  }
  return left;
}

// Who has the run's lock is the only one that makes tiles of it. Where one was killed after the old tiles had lost
// their name, they get it back.
void clear_left_tiles(const std::string& run) {
  const fs::path place = fs::path(run) / kTileFolder;
  const LeftTiles left = left_tiles_in(run);
  std::error_code failed;
  for (const fs::path& old : left.old) {
    if (lies_there(place) || !is_tile_folder(old.string())) continue;
    fs::rename(old, place, failed);
    if (failed) throw FileError(place.string(), "cannot be put back: " + failed.message());
  }
  for (const fs::path& old : left.old) {
    if (lies_there(old) && carry_over_foreign(old, place)) remove_tree(old, failed);
  }
  for (const fs::path& unfinished : left.unfinished) remove_tree(unfinished, failed);
}

/// A folder beside the tiles in which new ones are made; gone with the object unless it took their place.
class NewTiles {
 public:
  explicit NewTiles(const std::string& run)
      : place_(fs::path(run) / kTileFolder), folder_(fs::path(run) / fmt::format("{}{}", kNewPrefix, ::getpid())) {
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
  // The old ones go once the new ones have their name, but for files of others among them.
  void take_place() const {
    const fs::path old = folder_.string() + std::string(kOldSuffix);
    const bool has_old = lies_there(place_);
    std::error_code failed;
    if (has_old) fs::rename(place_, old, failed);
    if (failed) throw FileError(place(), "cannot be replaced: " + failed.message());
    fs::rename(folder_, place_, failed);
    if (failed) throw FileError(place(), "cannot be replaced: " + failed.message() + (has_old ? put_back(old) : ""));
    if (has_old && carry_over_foreign(old, place_)) remove_tree(old, failed);
  }

 private:
  // Says what cannot be undone.
  [[nodiscard]] std::string put_back(const fs::path& old) const {
    std::error_code failed;
    fs::rename(old, place_, failed);
    return failed ? fmt::format("; nor can {} be put back: {}", old.string(), failed.message()) : std::string();
  }

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
void bring_along(const NewTiles& fresh, const std::function<void()>& before_piece) {
  std::error_code failed;
  for (const fs::path& file : list_folder(fresh.place(), failed)) {
    const std::string name = file.filename().string();
    if (!is_old_tile(file) || name.starts_with('.')) continue;
    const fs::path there = fs::path(fresh.folder()) / name;
    std::error_code without_links;  // as some file systems are
    fs::create_hard_link(file, there, without_links);
    if (without_links) copy_file_atomically(file.string(), there.string(), before_piece);
  }
  if (failed) throw FileError(fresh.place(), "cannot be listed: " + failed.message());
}

// Makes some tiles again; the others stay.
void make_some(const std::vector<CellIndex>& only, const TileMaker& maker, const NewTiles& fresh,
               const std::function<void(double)>& progress, TilesOutcome& outcome) {
  bring_along(fresh, [&progress] { progress(0.0); });
  maker.make(
      only,
      [&](MapTile&& tile) {
        const TileRecord made = write_tile(fresh.folder(), tile);
        const auto record = std::find_if(outcome.index.tiles.begin(), outcome.index.tiles.end(),
                                         [&](const TileRecord& r) { return r.place == made.place; });
        if (record->sha256 != made.sha256) outcome.changed.push_back(made.place);
        *record = made;
        ++outcome.made;
      },
      progress);
  write_tile_index(fresh.folder(), outcome.index);
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
  // A folder that is none, or cannot be read, is told of as by any reader; and then the run is read once nobody else
  // writes to it.
  static_cast<void>(RunReader(request.run));
  const FolderLock lock(request.run);
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
  clear_left_tiles(request.run);
  if (request.only.empty()) {
    require_own(outcome.folder);
  } else {
    outcome.index = index_with(outcome.folder, hash);
    require_tiles(request.only, outcome.index, outcome.folder);
  }
  progress(0.0);
  const TileParts parts = outcome.index.has_occupancy ? TileParts::kBoth : TileParts::kDistances;
  const TileMaker maker(kept, config, settings.occupancy, changes_in(reader, kept, config), parts);
  const NewTiles fresh(request.run);
  if (request.only.empty()) {
    outcome.index = write_tiles(fresh.folder(), maker, hash, config.map.resolution_m, progress).index;
    outcome.made = outcome.index.tiles.size();
  } else {
    make_some(request.only, maker, fresh, progress, outcome);
  }
  reader.files().expect_unchanged();
  fresh.take_place();
  return outcome;
}

}  // namespace gdtslam
