#include "run_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "engine/io/sha256.hpp"
#include "run_reader.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A map that somebody cleaned by hand is the one thing that is changed on purpose.
std::string advice_on(const std::string& name) {
  const bool is_of_map = name == "map.pgm" || name == "map.yaml";
  return is_of_map
             ? "; 'gdtslam edit' changes a map, and map.yaml itself, named in place of the folder, is taken as it is"
             : "";
}

}  // namespace

Json files_json(const RunFolder& folder) {
  Json rows = Json::array();
  for (const std::string& name : std::set<std::string>(folder.names().begin(), folder.names().end())) {
    const std::string file = folder.staged_path(name);
    if (fs::is_directory(file)) continue;
    const HashedBytes hashed = sha256_of_file(file);
    rows.push_back({name, hashed.bytes, hashed.sha256});
  }
  return rows;
}

void refuse_folder_of_sites(const std::string& folder) {
  std::error_code ignored;
  if (!fs::exists(fs::path(folder) / kMergeFile, ignored)) return;
  const std::string site = (fs::path(folder) / "1").string();
  throw InputError({folder, 0}, "is what 'gdtslam merge' wrote; give one of its sites, " + site);
}

RunFiles::RunFiles(std::string folder, const std::function<void(const ReportReader&)>& also)
    : folder_(std::move(folder)) {
  report_state_ = state_of_file(path(kReportFile));
  if (!report_state_) {
    std::error_code ignored;
    if (!fs::exists(folder_, ignored)) throw InputError({folder_, 0}, "is no folder of a run: it is not there");
    if (!fs::is_directory(folder_, ignored)) throw InputError({folder_, 0}, "is a file; give the folder of a run");
    refuse_folder_of_sites(folder_);
    throw InputError({folder_, 0},
                     fmt::format("is no folder of a run: it has no {}{}{}", kReportFile, kMapAgain, folder_));
  }
  const ReportReader read = report();
  if (also) also(read);
  if (!read.has("files")) return;
  told_.emplace();
  for (ReportFile& file : read.files("files")) (*told_)[file.name] = std::move(file);
}

std::string RunFiles::path(const std::string& name) const { return (fs::path(folder_) / name).string(); }

bool RunFiles::has(const std::string& name) const {
  std::error_code ignored;
  return told_ ? told_->contains(name) : fs::exists(path(name), ignored);
}

std::string RunFiles::checked(const std::string& name) const {
  const std::optional<FileState> state = state_of_file(path(name));
  if (!state) refuse(name, "is missing in this run");
  if (!told_) return path(name);
  const auto told = told_->find(name);
  if (told == told_->end())
    refuse(name, fmt::format("is none of the files that {} names: not of one run", kReportFile));
  if (is_checked(name, *state)) return path(name);
  const ReportFile& file = told->second;
  if (state->bytes != file.bytes) {
    refuse(name, fmt::format("has {} bytes, but {} names {}: not of one run{}", state->bytes, kReportFile, file.bytes,
                             advice_on(name)));
  }
  if (unless_changed([&] { return sha256_of_file(path(name)); }).sha256 != file.sha256) {
    refuse(name, fmt::format("has another SHA-256 than {} names: not of one run{}", kReportFile, advice_on(name)));
  }
  const std::lock_guard lock(checked_->mutex);
  checked_->states[name] = *state;
  return path(name);
}

bool RunFiles::is_checked(const std::string& name, const FileState& state) const {
  const std::lock_guard lock(checked_->mutex);
  const auto found = checked_->states.find(name);
  return found != checked_->states.end() && found->second == state;
}

// A run takes its place as a whole: another one has another report.
void RunFiles::expect_unchanged() const {
  if (state_of_file(path(kReportFile)) == report_state_) return;
  throw InputError({folder_, 0}, "was changed or replaced while it was read; run the command again");
}

ReportReader RunFiles::report() const {
  return unless_changed([this] { return read_report(path(kReportFile), folder_); });
}

// If the whole run was replaced, that is what is wrong with the file.
void RunFiles::refuse(const std::string& name, const std::string& fault) const {
  expect_unchanged();
  throw InputError({path(name), 0}, fault + kMapAgain + folder_);
}

std::optional<RunFiles> told_files_in(const std::string& folder) {
  if (!RunReader::is_run(folder)) return std::nullopt;
  try {
    RunFiles files(folder);
    if (files.is_told()) return files;
  } catch (const InputError&) {  // a report of somebody else, or of another version
  }
  return std::nullopt;
}

}  // namespace gdtslam
