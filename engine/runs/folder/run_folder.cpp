#include "run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <ctime>
#include <memory>
#include <new>
#include <system_error>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
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
                               "cloud.png",        "continue.json",  "log-1.copy",  "edits.json",   "report.json"};

// Where the old files are while a commit lasts.
fs::path kept_in(const fs::path& staging) { return staging / kOldFiles; }

/// A staging folder, and the process that it belongs to.
struct Staging {
  fs::path folder;
  pid_t process = 0;
  // Where this process has the lock of the folder nobody else writes there, whoever has that number by now. Without a
  // lock the number tells; one of this process's own is of an earlier one: processes of a container begin at 1 again.
  [[nodiscard]] bool is_left(bool is_locked) const {
    return is_locked || process == ::getpid() || (::kill(process, 0) != 0 && errno == ESRCH);
  }
};

std::vector<Staging> stagings_in(const fs::path& folder) {
  std::vector<Staging> stagings;
  std::error_code ignored;  // what cannot be listed is not in the way
  for (const fs::path& entry : list_folder(folder, ignored)) {
    const std::string name = entry.filename().string();
    if (!name.starts_with(kStagingPrefix)) continue;
    pid_t process = 0;
    const char* const end = name.data() + name.size();
    const std::from_chars_result read = std::from_chars(name.data() + kStagingPrefix.size(), end, process);
    if (read.ec == std::errc{} && read.ptr == end && process > 0) stagings.push_back({entry, process});
  }
  return stagings;
}

// Nothing where somebody writes there, or it cannot be told.
std::unique_ptr<FolderLock> lock_of(const fs::path& folder) {
  try {
    auto lock = std::make_unique<FolderLock>(folder);
    return lock->is_held() ? std::move(lock) : nullptr;
  } catch (const Error&) {  // where there is no such folder, nobody writes to it
    return nullptr;
  }
}

// Staging folders of processes that were killed, but for that one.
std::vector<fs::path> leftovers_in(const fs::path& folder, bool is_locked, const fs::path& own = {}) {
  std::vector<fs::path> leftovers;
  for (const Staging& staging : stagings_in(folder)) {
    if (staging.is_left(is_locked) && staging.folder != own) leftovers.push_back(staging.folder);
  }
  return leftovers;
}

// What is left of a process that was killed within its commit is the only sign that the files beside it are of a run.
// Of 0.1.0 it has a folder `old`; a file of that name is a copy of the user's.
bool is_of_a_commit(const fs::path& leftover) {
  std::error_code ignored;
  return fs::exists(kept_in(leftover), ignored) || fs::is_directory(fs::symlink_status(leftover / "old", ignored));
}

// What a run that has just begun keeps there. To list a folder takes a descriptor, and the run may have ended because
// there was none left.
void remove_by_name(const fs::path& staging) {
  std::error_code ignored;
  for (const std::string_view name : kRunFiles) fs::remove(staging / name, ignored);
  for (int log = 2; fs::remove(staging / fmt::format("log-{}.copy", log), ignored);) ++log;
}

// Whether a folder is one that a run makes, by what it holds.
bool is_of_a_run(const fs::path& folder) {
  return (folder.filename() == kTileFolder && is_tile_folder(folder.string())) ||
         (folder.filename() == kSnapshotFolder && is_snapshot(folder.string()));
}

/// Which files of a folder a run of this program wrote, by what its report tells. All of them where the report is of a
/// version that told of none, or a run was killed while its files got their names.
class OwnFiles {
 public:
  OwnFiles(std::string folder, bool is_locked) : folder_(std::move(folder)) {
    const bool is_run = RunReader::is_gdtslam_run(folder_);
    if (is_run) run_ = told_files_in(folder_);
    const std::vector<fs::path> leftovers = leftovers_in(folder_, is_locked);
    are_all_ = (is_run && !run_) || std::any_of(leftovers.begin(), leftovers.end(), is_of_a_commit);
  }
  [[nodiscard]] bool has(const std::string& name) const {
    const std::string path = folder_ + "/" + name;
    if (name == kTileFolder) return is_tile_folder(path) && foreign_among_tiles(path).empty();
    return are_all_ || (run_ && (name == kReportFile || run_->has(name))) || is_of_a_run(path);
  }
  /// Those that the report tells of go with the run, whether the next one makes such files or not.
  [[nodiscard]] std::vector<std::string> names_that_go() const {
    return run_ ? run_->names_that_go() : std::vector<std::string>{};
  }
  /// Whether there is such a file of somebody else.
  [[nodiscard]] bool is_in_the_way(const std::string& name) const {
    return !has(name) && lies_there(fs::path(folder_) / name);
  }
  /// Throws UsageError then.
  void require(const std::string& name) const {
    if (!is_in_the_way(name)) return;
    throw UsageError(fmt::format(
        "--output: '{}' holds a {} that no run wrote; give another folder, or --force to replace it", folder_, name));
  }

 private:
  std::string folder_;
  std::optional<RunFiles> run_;
  bool are_all_ = false;
};

// "intel" from "../data/intel.clf.gz".
std::string stem_of(const std::string& log) {
  if (log == "-") return "stdin";
  fs::path name = fs::path(log).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

// Of a killed process that had this one's number, out of the way under one that no process has.
void set_aside(const fs::path& leftover) {
  constexpr int kBeyondProcesses = 2'000'000'000;
  std::error_code failed;
  for (int k = 0; k < 1000; ++k) {
    const fs::path aside = leftover.parent_path() / fmt::format("{}{}", kStagingPrefix, kBeyondProcesses + k);
    if (fs::exists(fs::symlink_status(aside, failed))) continue;
    fs::rename(leftover, aside, failed);
    break;
  }
  if (failed) throw FileError(leftover.string(), "cannot be set aside: " + failed.message());
}

std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour,
                     utc.tm_min, utc.tm_sec);
}

}  // namespace

RunFolder::MadeFolder::MadeFolder(const fs::path& path) {
  std::error_code ignored;
  for (fs::path made = path; !made.empty() && !fs::exists(made, ignored); made = made.parent_path()) {
    made_.push_back(made);
  }
  make_folder(path.string());
}

RunFolder::MadeFolder::~MadeFolder() {
  std::error_code ignored;
  for (const fs::path& made : made_) fs::remove(made, ignored);  // succeeds only when it is empty
}

RunFolder::RunFolder(const std::string& path, ForeignFiles foreign) : folder_(path), foreign_(foreign) {
  made_.emplace(folder_);
  lock_.emplace(folder_);
  std::error_code failed;
  staging_ = folder_ / fmt::format("{}{}", kStagingPrefix, ::getpid());
  if (fs::exists(staging_, failed)) set_aside(staging_);
  remove_tree(staging_, failed);
  if (!fs::create_directory(staging_, failed)) {
    throw FileError(path, "cannot be written to: " + failed.message());
  }
}

std::vector<fs::path> RunFolder::leftovers() const { return leftovers_in(folder_, lock_->is_held(), staging_); }

void RunFolder::remove_leftovers() const {
  std::error_code ignored;
  for (const fs::path& leftover : leftovers()) {
    if (!is_of_a_commit(leftover)) remove_tree(leftover, ignored);
  }
}

RunFolder::RunFolder(const std::string& path, const fs::path& leftover, ForeignFiles foreign)
    : folder_(path),
      staging_(folder_ / fmt::format("{}{}", kStagingPrefix, ::getpid())),
      foreign_(foreign),
      stays_(true) {
  lock_.emplace(folder_);
  std::error_code failed;
  if (fs::equivalent(leftover, staging_, failed)) return;  // the killed process had this one's number
  if (fs::exists(staging_, failed)) set_aside(staging_);
  fs::rename(leftover, staging_, failed);
  if (failed) throw FileError(path, "cannot be written to: " + failed.message());
}

RunFolder::~RunFolder() {
  if (staging_.empty() || stays_ || holds_only_copy_) return;
  without_throwing([this] {
    std::error_code ignored;
    remove_by_name(staging_);
    if (!fs::remove(staging_, ignored)) remove_tree(staging_, ignored);
  });
}

void RunFolder::keep(std::span<const std::string> names) {
  stays_ = true;
  std::error_code ignored;
  for (const fs::path& file : list_folder(staging_, ignored)) {
    if (std::find(names.begin(), names.end(), file.filename()) == names.end()) remove_tree(file, ignored);
  }
}

std::string RunFolder::staged(std::string_view name) {
  names_.emplace_back(name);
  return (staging_ / name).string();
}

std::string RunFolder::staged_folder(std::string_view name) {
  std::string folder = staged(name);
  make_folder(folder);
  return folder;
}

void RunFolder::move(const fs::path& from, const fs::path& to, const std::string& name) const {
  std::error_code failed;
  fs::rename(from / name, to / name, failed);
  if (failed) throw FileError(file(name), "cannot be replaced: " + failed.message());
}

void RunFolder::replace(const std::vector<std::string>& old_names) {
  for (auto name = old_names.rbegin(); name != old_names.rend(); ++name) {
    std::error_code ignored;  // what cannot be asked about cannot be replaced either
    const fs::file_status status = fs::symlink_status(folder_ / *name, ignored);
    if (fs::is_directory(status) && !is_of_a_run(folder_ / *name))
      throw FileError(file(*name), "cannot be replaced: " + errno_text(EISDIR));
    if (fs::exists(status)) move(folder_, kept_in(staging_), *name);
  }
  sync_folder(folder_.string());  // no new file on the disk before the old ones are gone from it
  for (given_ = 0; given_ < names_.size(); ++given_) move(staging_, folder_, names_[given_]);
  sync_folder(folder_.string());
}

// Undoes a commit that failed; says what cannot be undone.
std::string RunFolder::put_back(const std::vector<std::string>& old_names) const {
  std::string problems;
  std::error_code failed;
  for (std::size_t k = 0; k < given_; ++k) {
    remove_tree(folder_ / names_[k], failed);
    if (failed) problems += "; nor can " + file(names_[k]) + " be removed again: " + failed.message();
  }
  for (const std::string& name : old_names) {
    const fs::path kept = kept_in(staging_) / name;
    if (!fs::exists(fs::symlink_status(kept, failed))) continue;
    fs::rename(kept, folder_ / name, failed);
    if (failed) problems += "; nor can " + kept.string() + " be put back: " + failed.message();
  }
  return problems;
}

void RunFolder::undo(const std::vector<std::string>& old_names) {
  const std::string problems = put_back(old_names);
  holds_only_copy_ = !problems.empty();
  try {
    throw;
  } catch (const Error& error) {
    if (problems.empty()) throw;
    throw Error(error.code(), error.what() + problems);
  } catch (const std::bad_alloc&) {
    if (problems.empty()) throw;
    throw Error(ExitCode::kFailed, "out of memory" + problems);
  }
}

// Somebody may have put a file there since the run began: what was made is not lost for it, and can be gone on with.
std::vector<std::string> RunFolder::replaced_names() {
  const OwnFiles own(folder_.string(), lock_->is_held());
  // What makes no run, as a merge in the folder of its sites, leaves one that lies there.
  const auto reports =
      std::count(names_.begin(), names_.end(), kReportFile) + std::count(gone_.begin(), gone_.end(), kReportFile);
  std::vector<std::string> old_names = reports > 0 ? own.names_that_go() : std::vector<std::string>{};
  const bool are_all = foreign_ == ForeignFiles::kReplaced;
  for (const std::string& name : gone_) {
    if (are_all || own.has(name)) old_names.push_back(name);
  }
  for (const std::string& name : names_) {
    stays_ = stays_ || (!are_all && own.is_in_the_way(name));
    if (!are_all) own.require(name);
    old_names.push_back(name);
  }
  return old_names;
}

void RunFolder::commit(Leftovers leftovers) {
  const std::vector<std::string> old_names = replaced_names();
  sync_folder(staging_.string());
  std::error_code failed;
  fs::create_directory(kept_in(staging_), failed);
  if (failed) throw FileError(folder_.string(), "cannot be written to: " + failed.message());
  holds_only_copy_ = true;
  try {
    replace(old_names);
  } catch (...) {
    undo(old_names);
  }
  holds_only_copy_ = false;
  names_.clear();
  std::error_code ignored;  // they are in nobody's way
  stays_ = false;
  if (leftovers == Leftovers::kKept) return;
  for (const fs::path& leftover : this->leftovers()) remove_tree(leftover, ignored);
}

void remove_stagings_of_ended_runs(const std::string& folder) {
  const std::unique_ptr<FolderLock> lock = lock_of(folder);
  for (const fs::path& leftover : leftovers_in(folder, lock != nullptr)) {
    std::error_code failed;
    remove_tree(leftover, failed);
    if (failed) throw FileError(leftover.string(), "cannot be removed: " + failed.message());
  }
}

UnfinishedRun unfinished_run_in(const std::string& folder, const char* file) {
  UnfinishedRun newest;
  fs::file_time_type newest_time = fs::file_time_type::min();
  std::error_code ignored;
  const std::unique_ptr<FolderLock> lock = lock_of(folder);
  for (const Staging& staging : stagings_in(folder)) {
    if (!staging.is_left(lock != nullptr)) {
      throw UsageError(fmt::format("process {} is writing to '{}': end it first", staging.process, folder));
    }
    const bool is_of_commit = is_of_a_commit(staging.folder);
    if (!is_of_commit && !fs::exists(staging.folder / file, ignored)) continue;
    const fs::file_time_type time = fs::last_write_time(staging.folder, ignored);
    if (!newest.folder.empty() && time < newest_time) continue;
    newest = {staging.folder, is_of_commit};
    newest_time = time;
  }
  return newest;
}

void require_no_foreign_files(const std::string& folder, std::span<const std::string> besides) {
  const OwnFiles own(folder, lock_of(folder) != nullptr);
  for (const char* name : kRunFiles) own.require(name);
  for (const std::string& name : besides) own.require(name);
  require_no_foreign_among_tiles(folder);
}

bool is_file_of_a_run(std::string_view name) {
  const auto is_numbered = [name](std::string_view begin, std::string_view end) {
    return name.size() > begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end) &&
           is_digits(name.substr(begin.size(), name.size() - begin.size() - end.size()));
  };
  return std::find(kRunFiles.begin(), kRunFiles.end(), name) != kRunFiles.end() || is_numbered("log-", ".copy") ||
         is_numbered("session-", ".tum") || name == "tiles" || name.starts_with(kStagingPrefix);
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
