#include "run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <optional>
#include <system_error>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/tiles/tile_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "run_files.hpp"
#include "run_reader.hpp"
#include "snapshot_folder.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::array kRunFiles{"trajectory.tum",   "covariance.csv", "graph.g2o",   "map.yaml",     "map.pgm",
                               "keyframes.bin.gz", "gdt.yaml",       "gdt.png",     "overview.png", "overview.svg",
                               "graph.png",        "graph.svg",      "config.yaml", "linkage.yaml", "cloud.ply",
                               "cloud.png",        "continue.json",  "edits.json",  "report.json"};
constexpr std::string_view kLogEnding = ".jsonl.zst";

bool is_numbered(std::string_view name, std::string_view begin, std::string_view end) {
  return name.size() > begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end) &&
         is_digits(name.substr(begin.size(), name.size() - begin.size() - end.size()));
}

bool is_merge_report(const fs::path& file) {
  try {
    const nlohmann::ordered_json report = read_json(file.string(), kMostReportBytes);
    return report.is_object() && report.contains("format") && report.contains("sites") && report.contains("searches");
  } catch (const Error&) {  // of somebody else
    return false;
  }
}

// Names of tiles and snapshots that a killed process left unfinished.
bool is_staging_of_part(const std::string& name) {
  return name == staging_name(kTileFolder) || name == staging_name(kSnapshotFolder);
}

/// Which entries of a folder are of a run or a merge of this program, by what its report says. The report of an old
/// version names no files; there the names of a run's files count.
class OwnEntries {
 public:
  explicit OwnEntries(const fs::path& folder)
      : is_run_(RunReader::is_gdtslam_run(folder.string())), is_merge_(is_merge_report(folder / kMergeFile)) {
    if (is_run_) run_ = told_files_in(folder.string());
  }
  [[nodiscard]] bool has(const fs::path& entry) const {
    const std::string name = entry.filename().string();
    std::error_code ignored;
    if (fs::is_directory(fs::symlink_status(entry, ignored))) return is_own_folder(entry, name);
    if (is_merge_ && name == kMergeFile) return true;
    return is_run_ && (name == kReportFile || (run_ ? run_->has(name) : is_file_of_a_run(name)));
  }

 private:
  [[nodiscard]] bool is_own_folder(const fs::path& entry, const std::string& name) const;

  bool is_run_;
  bool is_merge_;
  std::optional<RunFiles> run_;
};

// In the order of their names.
// NOLINTNEXTLINE(misc-no-recursion): as deep as sites lie in a merge
std::vector<fs::path> foreign_entries(const fs::path& folder) {
  std::error_code failed;
  std::vector<fs::path> entries = list_folder(folder, failed);
  if (failed == std::errc::no_such_file_or_directory) return {};
  if (failed) throw FileError(folder.string(), "cannot be listed: " + failed.message());
  if (entries.empty()) return {};
  const OwnEntries own(folder);
  std::erase_if(entries, [&own](const fs::path& entry) { return own.has(entry); });
  std::sort(entries.begin(), entries.end());
  return entries;
}

// NOLINTNEXTLINE(misc-no-recursion): as deep as sites lie in a merge
bool OwnEntries::is_own_folder(const fs::path& entry, const std::string& name) const {
  if (is_staging_of_part(name)) {
    const FolderLock lock(entry);  // nobody is at work on it
    return true;
  }
  if (name == kSnapshotFolder) return is_snapshot(entry.string());
  if (name == kTileFolder) return is_tile_folder(entry.string()) && foreign_among_tiles(entry.string()).empty();
  return is_merge_ && is_digits(name) && is_site(entry.string()) && foreign_entries(entry).empty();
}

void require_replaceable(const std::string& path, ForeignFiles foreign) {
  for (const fs::path& entry : foreign_entries(path)) {
    std::error_code ignored;
    const std::string name = entry.filename().string();
    if (fs::is_directory(fs::symlink_status(entry, ignored))) {
      throw UsageError(
          fmt::format("--output: '{}' holds a folder {} that no run wrote; give another folder", path, name));
    }
    if (foreign == ForeignFiles::kReplaced) continue;
    throw UsageError(fmt::format(
        "--output: '{}' holds a {} that no run wrote; give another folder, or --force to remove it", path, name));
  }
}

// Without a slash at the end.
std::string replaceable(const std::string& path, ForeignFiles foreign) {
  require_replaceable(path, foreign);
  const fs::path named(path);
  return named.has_filename() ? path : named.parent_path().string();
}

// Beside the folder, under a name that is free.
std::string kept_beside(const fs::path& folder, const fs::path& log) {
  std::string kept;
  int number = 1;
  do {
    kept = fmt::format("{}-left-{}{}", folder.string(), number++, kLogEnding);
  } while (lies_there(kept));
  std::error_code failed;
  fs::rename(log, kept, failed);
  if (failed) throw FileError(kept, "cannot be written: " + failed.message());
  return kept;
}

// Whether the folder has the same log, as a run that is continued has.
bool has_same_log(const fs::path& folder, const fs::path& log) {
  std::error_code failed;
  const fs::path other = folder / log.filename();
  if (!fs::is_regular_file(other, failed)) return false;
  return sha256_of_file(other.string()).sha256 == sha256_of_file(log.string()).sha256;
}

// "intel" from "../data/intel.clf.gz".
std::string stem_of(const std::string& log) {
  if (log == "-") return "stdin";
  fs::path name = fs::path(log).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour,
                     utc.tm_min, utc.tm_sec);
}

}  // namespace

RunFolder::RunFolder(const std::string& path, ForeignFiles foreign)
    : path_(replaceable(path, foreign)),
      foreign_(foreign),
      transaction_(path_, [this](const fs::path& removed, bool is_old) { before_removal(removed, is_old); }) {}

// The logs of streams cannot be had again, and something may have come into the old folder at the last moment.
void RunFolder::before_removal(const fs::path& removed, bool is_old) {
  if (is_old) require_replaceable(removed.string(), foreign_);
  const fs::path folder = target_of(removed);
  std::error_code ignored;  // what cannot be listed shows when it cannot be removed
  for (const fs::path& file : list_folder(removed, ignored)) {
    const bool is_log = is_kept_log(file.filename().string()) && fs::is_regular_file(file, ignored);
    if (!is_log || fs::is_empty(file, ignored) || (is_old && has_same_log(folder, file))) continue;
    left_logs_.push_back(kept_beside(folder, file));
  }
}

std::string RunFolder::staged(std::string_view name) {
  names_.emplace_back(name);
  return staged_path(name);
}

std::string RunFolder::staged_folder(std::string_view name) {
  std::string folder = staged(name);
  make_folder(folder);
  return folder;
}

std::string RunFolder::staged_path(std::string_view name) const { return (transaction_.staging() / name).string(); }

std::string RunFolder::keep_log(const std::string& name) {
  try {
    return kept_beside(transaction_.target(), staged_path(name));
  } catch (const FileError&) {  // it stays where it is then, with all else
    transaction_.leave();
    return staged_path(name);
  }
}

void RunFolder::commit() {
  require_replaceable(path_, foreign_);
  transaction_.commit();
}

std::string RunFolder::file(std::string_view name) const { return (fs::path(path_) / name).string(); }

std::string kept_log_name(std::size_t log) { return fmt::format("log-{}{}", log + 1, kLogEnding); }

bool is_kept_log(std::string_view name) { return is_numbered(name, "log-", kLogEnding); }

bool is_file_of_a_run(std::string_view name) {
  return std::find(kRunFiles.begin(), kRunFiles.end(), name) != kRunFiles.end() || is_kept_log(name) ||
         is_numbered(name, "log-", ".copy") || is_numbered(name, "session-", ".tum") || name == kTileFolder;
}

bool is_site(const std::string& folder) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(folder, ignored)) || !RunReader::is_gdtslam_run(folder)) return false;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(kFirstSession) && !run->report().has("edited");
}

std::string default_run_folder(const std::string& log) {
  const std::string base = fmt::format("runs/{}-{}", stem_of(log), utc_time());
  std::string path = base;
  std::error_code ignored;
  for (int k = 2; fs::exists(path, ignored); ++k) path = fmt::format("{}-{}", base, k);
  return path;
}

void link_latest(const std::string& run_folder) {
  const fs::path folder(run_folder);
  const fs::path link = folder.parent_path() / "latest";
  std::error_code failed;
  if (fs::exists(fs::symlink_status(link, failed)) && !fs::is_symlink(fs::symlink_status(link, failed))) return;
  const fs::path temporary = folder.parent_path() / fmt::format(".latest-{}", ::getpid());
  fs::remove(temporary, failed);
  fs::create_directory_symlink(folder.filename(), temporary, failed);
  if (!failed) fs::rename(temporary, link, failed);
  if (failed) throw FileError(link.string(), "cannot be linked to the run: " + failed.message());
}

}  // namespace gdtslam
