#include "merge_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <tuple>
#include <vector>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/sites/site_places.hpp"
#include "engine/runs/tiles/tile_folder.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOldReport = "old.json";  // as long as sites are replaced
constexpr const char* kWrittenSite = "site";

const std::string& checked_place(const std::string& folder, std::size_t sessions, bool replaces_foreign_files) {
  std::vector<std::string> names = names_of_changes();
  for (std::size_t k = 0; k < sessions; ++k) names.push_back(session_file(k));
  if (!replaces_foreign_files) require_no_foreign_files(folder, names);
  return folder;
}

bool is_report_of_a_merge(const fs::path& file) {
  try {
    const nlohmann::ordered_json report = read_json(file.string(), kMostReportBytes);
    return report.is_object() && report.contains("format") && report.contains("sites") && report.contains("searches");
  } catch (const InputError&) {  // of somebody else
    return false;
  }
}

const std::string& checked_folder(const std::string& folder, bool replaces_foreign_files) {
  const fs::path report = fs::path(folder) / kMergeFile;
  std::error_code ignored;
  if (fs::is_directory(fs::symlink_status(report, ignored))) {
    throw FileError(report.string(), "cannot be replaced: " + errno_text(EISDIR));
  }
  if (!replaces_foreign_files && lies_there(report) &&
      !(fs::is_regular_file(report, ignored) && is_report_of_a_merge(report))) {
    throw UsageError(
        fmt::format("--output: '{}' holds a {} that no merge wrote; give another folder, or --force to replace it",
                    folder, kMergeFile));
  }
  return folder;
}

// What others refer to before the YAML that refers to it, and last the report, without which a folder is no run.
std::vector<std::string> names_in_order(const fs::path& folder, std::error_code& failed) {
  std::vector<std::string> names;
  for (const fs::path& file : list_folder(folder, failed)) names.push_back(file.filename().string());
  const auto key = [](const std::string& name) {
    return std::make_tuple(name == kReportFile, name.ends_with(".yaml"), std::cref(name));
  };
  std::sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
  return names;
}

// What a drive that was killed there left may be all that there is of its log.
bool is_leftover_of_a_merge(const fs::path& leftover) {
  std::error_code failed;
  const std::vector<fs::path> files = list_folder(leftover, failed);
  const auto has_name_or_nothing = [](const fs::path& file) {
    std::error_code ignored;
    const std::string name = file.filename().string();
    return name == kMergeFile || name == kOldReport || is_temporary_of(kMergeFile, name) || fs::is_empty(file, ignored);
  };
  return !failed && (lies_there(leftover / kWrittenSite) || std::ranges::all_of(files, has_name_or_nothing));
}

// After the commit, which is done whatever becomes of them.
void remove_leftovers_in(const RunFolder& folder, bool has_new_run) {
  without_throwing([&] {
    std::error_code ignored;
    for (const fs::path& leftover : folder.leftovers()) {
      if (has_new_run || is_leftover_of_a_merge(leftover)) remove_tree(leftover, ignored);
    }
  });
}

}  // namespace

std::string session_file(std::size_t run) { return fmt::format("session-{}.tum", run + 1); }

SiteFolder::SiteFolder(const std::string& path, std::size_t sessions, bool replaces_foreign_files)
    : replaces_foreign_files_(replaces_foreign_files),
      folder_(std::make_unique<RunFolder>(checked_place(path, sessions, replaces_foreign_files),
                                          replaces_foreign_files ? ForeignFiles::kReplaced : ForeignFiles::kKept)) {}

// The report, which a replaced one does not tell of itself, is the last of the list and goes first.
SiteFolder::SiteFolder(const std::string& path) : folder_(std::make_unique<RunFolder>(path)) {
  leave_out_old();
  folder_->without(kReportFile);
  require_replaceable();
}

// Of a run whose report tells of its files exactly those go; else all that have the names of a run's.
void SiteFolder::leave_out_old() {
  const std::optional<RunFiles> run = told_files_in(path());
  const std::vector<std::string> changes = names_of_changes();
  const auto is_old = [&](const std::string& name) {
    if (name.starts_with(".")) return false;  // staged, or of somebody else
    if (name == kTileFolder) return is_tile_folder(folder_->file(name));
    if (run && (run->has(name) || !replaces_foreign_files_)) return run->has(name);
    return is_file_of_a_run(name) || std::find(changes.begin(), changes.end(), name) != changes.end();
  };
  std::error_code ignored;  // what cannot be listed cannot be replaced either
  for (const fs::path& file : list_folder(path(), ignored)) {
    if (is_old(file.filename().string())) gone_.push_back(file.filename().string());
  }
  for (const std::string& name : gone_) folder_->without(name);
  leave_out_edits(*folder_);
}

void SiteFolder::require_replaceable() const {
  std::vector<std::string> names = folder_->names();
  names.insert(names.end(), gone_.begin(), gone_.end());
  for (const std::string& name : names) {
    std::error_code ignored;
    if (name == kTileFolder || !fs::is_directory(fs::symlink_status(folder_->file(name), ignored))) continue;
    throw FileError(folder_->file(name), "cannot be replaced: " + errno_text(EISDIR));
  }
}

std::string SiteFolder::written() const { return folder_->staged_path(kWrittenSite); }

void SiteFolder::take_over() {
  leave_out_old();
  const fs::path from = written();
  std::error_code failed;
  const std::vector<std::string> names = names_in_order(from, failed);
  if (failed) throw FileError(path(), "cannot be read: " + failed.message());
  for (const std::string& name : names) {
    fs::rename(from / name, folder_->staged(name), failed);
    if (failed) throw FileError(folder_->file(name), "cannot be written: " + failed.message());
  }
  require_replaceable();
}

void SiteFolder::commit() {
  names_ = folder_->names();
  folder_->commit(RunFolder::Leftovers::kKept);
}

void SiteFolder::remove_leftovers() const { remove_leftovers_in(*folder_, !names_.empty()); }

// A committed run folder has the old files beside the staged ones until it is gone itself. They are listed before a new
// one is removed, for that may fail.
std::string SiteFolder::undo() {
  const fs::path old = folder_->old_files();
  std::error_code failed;
  const std::vector<std::string> old_names = names_in_order(old, failed);
  std::string problems;
  if (failed) problems = fmt::format("; nor can {} be read: {}", old.string(), failed.message());
  for (auto name = names_.rbegin(); name != names_.rend() && problems.empty(); ++name) {
    remove_tree(folder_->file(*name), failed);
    if (failed) problems = fmt::format("; nor can {} be removed again: {}", folder_->file(*name), failed.message());
  }
  for (auto name = old_names.begin(); name != old_names.end() && problems.empty(); ++name) {
    fs::rename(old / *name, folder_->file(*name), failed);
    if (failed) problems = fmt::format("; nor can {} be put back: {}", (old / *name).string(), failed.message());
  }
  // NOLINTNEXTLINE(bugprone-unused-return-value): with its destructor it would remove the only copy
  if (!problems.empty()) static_cast<void>(folder_.release());
  return problems;
}

MergeFolder::MergeFolder(const std::string& path, bool replaces_foreign_files)
    : path_(path),
      replaces_foreign_files_(replaces_foreign_files),
      folder_(checked_folder(path, replaces_foreign_files), ForeignFiles::kReplaced) {}

SiteFolder& MergeFolder::add_site(std::size_t sessions) {
  return sites_.emplace_back(fmt::format("{}/{}", path_, sites_.size() + 1), sessions, replaces_foreign_files_);
}

void MergeFolder::leave_out_others() {
  written_sites_ = sites_.size();
  for (const std::string& path : sites_beyond(path_, written_sites_)) sites_.emplace_back(path);
}

// Once nothing is staged in them.
void MergeFolder::remove_empty_folders() {
  while (sites_.size() > written_sites_) {
    const std::string path = sites_.back().path();
    sites_.pop_back();
    std::error_code ignored;  // what somebody put there stays
    fs::remove(path, ignored);
  }
}

void MergeFolder::set_old_report_aside() const {
  std::error_code failed;
  if (!lies_there(folder_.file(kMergeFile))) return;
  fs::rename(folder_.file(kMergeFile), folder_.staged_path(kOldReport), failed);
  if (failed) throw FileError(folder_.file(kMergeFile), "cannot be replaced: " + failed.message());
  sync_folder(path_);
}

std::string MergeFolder::put_back(std::size_t committed) {
  std::string problems;
  for (std::size_t k = committed; k > 0; --k) problems += sites_[k - 1].undo();
  if (!problems.empty() || !lies_there(folder_.staged_path(kOldReport))) return problems;
  std::error_code failed;
  fs::rename(folder_.staged_path(kOldReport), folder_.file(kMergeFile), failed);
  if (failed) problems = fmt::format("; nor can {} be put back: {}", folder_.file(kMergeFile), failed.message());
  return problems;
}

void MergeFolder::commit(std::string_view report) {
  write_file_atomically(folder_.staged(kMergeFile), report);
  std::size_t committed = 0;
  try {
    set_old_report_aside();
    for (; committed < sites_.size(); ++committed) sites_[committed].commit();
    folder_.commit(RunFolder::Leftovers::kKept);
  } catch (const Error& error) {
    const std::string problems = put_back(committed);
    if (problems.empty()) throw;
    throw Error(error.code(), error.what() + problems);
  } catch (const std::bad_alloc&) {
    const std::string problems = put_back(committed);
    if (problems.empty()) throw;
    throw Error(ExitCode::kFailed, "out of memory" + problems);
  }
  for (const SiteFolder& site : sites_) site.remove_leftovers();
  remove_leftovers_in(folder_, false);
  remove_empty_folders();
}

}  // namespace gdtslam
