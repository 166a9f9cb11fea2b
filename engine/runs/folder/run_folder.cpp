#include "run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/tiles/map_tiles.hpp"
#include "gdtslam/core/error.hpp"

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
  } catch (const Error&) {  // a file of another program
    return false;
  }
}

/// Tells which entries of a folder belong to a run or a merge of this program, by its report. A report of an old
/// version lists no files; then the usual names of a run's files count.
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

// Sorted by name.
// NOLINTNEXTLINE(misc-no-recursion): as deep as sites lie in a merge
std::vector<fs::path> foreign_entries(const fs::path& folder) {
  std::error_code failed;
  std::vector<fs::path> entries = list_folder(folder, failed);
  if (failed == std::errc::no_such_file_or_directory || entries.empty()) return {};
  if (failed) throw FileError(folder.string(), "cannot be listed: " + failed.message());
  const OwnEntries own(folder);
  std::erase_if(entries, [&own](const fs::path& entry) { return own.has(entry); });
  std::sort(entries.begin(), entries.end());
  return entries;
}

// NOLINTNEXTLINE(misc-no-recursion): as deep as sites lie in a merge
bool OwnEntries::is_own_folder(const fs::path& entry, const std::string& name) const {
  if (name == staging_name(kSnapshotFolder)) return true;  // left by a killed drive
  if (name == kSnapshotFolder) return is_snapshot(entry.string());
  if (name == kTileFolder) return is_tile_folder(entry.string());
  return is_merge_ && is_digits(name) && is_site(entry.string()) && foreign_entries(entry).empty();
}

// A free name beside the folder.
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

// "intel" from "../data/intel.clf.gz".
std::string log_stem(const std::string& log) {
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

// weakly_canonical() does not resolve a link to a missing file, but the file would be made at its target.
fs::path behind_links(fs::path file) {
  constexpr int kMostLinks = 40;  // the limit of the system
  std::error_code failed;
  for (int k = 0; k < kMostLinks && fs::is_symlink(fs::symlink_status(file, failed)); ++k) {
    const fs::path target = fs::read_symlink(file, failed);
    if (failed) break;
    file = file.parent_path() / target;
  }
  return file;
}

}  // namespace

RunFolder::RunFolder(const std::string& path, bool replaces_files)
    : path_(fs::path(path).has_filename() ? path : fs::path(path).parent_path().string()),
      replaces_files_(replaces_files),
      transaction_((require_replaceable(), path_), [this](const fs::path& left) { keep_logs(left); }) {}

void RunFolder::require_replaceable() const {
  for (const fs::path& entry : foreign_entries(path_)) {
    std::error_code ignored;
    const bool is_folder = fs::is_directory(fs::symlink_status(entry, ignored));
    if (!is_folder && replaces_files_) continue;
    throw UsageError(fmt::format("--output: '{}' holds a {}{} that no run wrote; give another folder{}", path_,
                                 is_folder ? "folder " : "", entry.filename().string(),
                                 is_folder ? "" : ", or --force to remove it"));
  }
}

// Nobody can read again the stream of a killed process.
void RunFolder::keep_logs(const fs::path& left) {
  std::error_code ignored;  // a folder that cannot be listed cannot be removed either, which is reported
  for (const fs::path& file : list_folder(left, ignored)) {
    const bool is_log = is_kept_log(file.filename().string()) && fs::is_regular_file(file, ignored);
    if (is_log && !fs::is_empty(file, ignored)) left_logs_.push_back(kept_beside(path_, file));
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
  return kept_beside(transaction_.target(), staged_path(name));
}

void RunFolder::commit() {
  require_replaceable();
  transaction_.commit();
}

std::string RunFolder::file(std::string_view name) const { return (fs::path(path_) / name).string(); }

std::string kept_log_name(std::size_t log) { return fmt::format("log-{}{}", log + 1, kLogEnding); }

bool is_kept_log(std::string_view name) { return is_numbered(name, "log-", kLogEnding); }

std::string session_file_name(std::size_t run) { return fmt::format("session-{}.tum", run + 1); }

bool is_file_of_a_run(std::string_view name) {
  return std::find(kRunFiles.begin(), kRunFiles.end(), name) != kRunFiles.end() || is_kept_log(name) ||
         is_numbered(name, "log-", ".copy") || is_numbered(name, "session-", ".tum") || name == kTileFolder;
}

bool is_site(const std::string& folder) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(folder, ignored)) || !RunReader::is_gdtslam_run(folder)) return false;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(session_file_name(0)) && !run->report().has("edited");
}

std::string default_run_folder(const std::string& log) {
  const std::string name = fmt::format("{}-{}", log_stem(log), utc_time());
  const auto is_taken = [](const std::string& free) {  // by a run, finished or being written
    return lies_there("runs/" + free) || lies_there("runs/" + staging_name(free));
  };
  std::string free = name;
  for (int k = 2; is_taken(free); ++k) free = fmt::format("{}-{}", name, k);
  return "runs/" + free;
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

fs::path place_of_file(const std::string& file) {
  std::error_code failed;
  const fs::path named = fs::absolute(file, failed);
  if (failed) return file;
  const fs::path place = fs::weakly_canonical(behind_links(named), failed);
  if (failed) return named.lexically_normal();
  return place.has_filename() ? place : place.parent_path();  // a slash at the end names the same
}

bool lies_in(const std::string& folder, const std::string& file) {
  const fs::path below = place_of_file(file).lexically_relative(place_of_file(folder));
  return !below.empty() && *below.begin() != ".." && *below.begin() != ".";
}

bool is_run_file_in(const std::string& folder, const std::string& file) {
  if (!lies_in(folder, file)) return false;
  const std::string name = place_of_file(file).lexically_relative(place_of_file(folder)).begin()->string();
  if (is_file_of_a_run(name)) return true;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(name);
}

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kSnapshotFiles{kSnapshotMap, "map.pgm", kSnapshotTrajectory};

bool is_file_of_a_snapshot(const fs::path& path) {
  const std::string name = path.filename().string();
  std::error_code ignored;
  return std::find(kSnapshotFiles.begin(), kSnapshotFiles.end(), name) != kSnapshotFiles.end() &&
         fs::is_regular_file(fs::symlink_status(path, ignored));
}

}  // namespace

// A folder that cannot be listed counts as foreign.
bool is_snapshot(const std::string& folder) {
  std::error_code failed;
  if (!fs::is_directory(fs::symlink_status(folder, failed))) return false;
  const std::vector<fs::path> files = list_folder(folder, failed);
  return !failed && files.size() == kSnapshotFiles.size() &&
         std::all_of(files.begin(), files.end(), is_file_of_a_snapshot);
}

void remove_snapshot(const std::string& folder) {
  std::error_code ignored;
  for (const std::string_view name : kSnapshotFiles) fs::remove(fs::path(folder) / name, ignored);
  fs::remove(folder, ignored);
}

void require_no_foreign_snapshot(const std::string& run_folder) {
  const std::string folder = (fs::path(run_folder) / kSnapshotFolder).string();
  std::error_code ignored;  // a place that cannot be examined cannot be replaced either
  if (!fs::exists(fs::symlink_status(folder, ignored)) || is_snapshot(folder)) return;
  throw UsageError(fmt::format(
      "--output: '{}' is no snapshot of a drive, and one would have its name; give another folder", folder));
}

}  // namespace gdtslam
