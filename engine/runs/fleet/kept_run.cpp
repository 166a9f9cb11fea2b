#include "kept_run.hpp"

#include <filesystem>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "record.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRemoveIt = "; remove that folder and run its shard again";

// Of what is not there the innermost folder that is. Behind a link to a disk that is not mounted a run may lie.
void require_no_dead_link(fs::path path) {
  while (!lies_there(path) && path.has_parent_path()) path = path.parent_path();
  std::error_code ignored;
  if (lies_there(path) && !fs::exists(path, ignored)) {
    throw FileError(path.string(), "is a link that leads nowhere; mount what it leads to, or remove it");
  }
}

bool has_report_in(const std::string& run_folder) {
  const std::string report = run_folder + "/" + kReportFile;
  std::error_code failed;
  const fs::file_status status = fs::status(report, failed);
  if (fs::is_regular_file(status)) return true;
  if (!fs::status_known(status)) throw FileError(report, "cannot be read: " + failed.message());
  if (!fs::exists(status)) require_no_dead_link(report);
  return false;
}

}  // namespace

bool has_report(const std::string& atlas, const std::string& run) { return has_report_in(atlas + "/" + run_path(run)); }

bool is_run_there(const std::string& run_folder) {
  if (has_report_in(run_folder)) return true;
  if (!lies_there(run_folder)) return false;
  std::error_code failed;
  const bool is_folder = fs::is_directory(fs::symlink_status(run_folder, failed));
  if (is_folder && list_folder(run_folder, failed).empty() && !failed) return false;
  if (is_folder && failed) throw FileError(run_folder, "cannot be listed: " + failed.message());
  throw FileError(run_folder, "is no whole run, and nothing writes such a one here; remove it and run the shard again");
}

void require_whole_run(const std::string& run_folder) {
  try {
    const RunFiles files(run_folder);
    for (const std::string& name : files.names()) (void)files.checked(name);
    files.expect_unchanged();
  } catch (const InputError& error) {
    throw InputError(said_in_atlas(error.what()));
  }
}

void require_run_of_plan(const std::string& run_folder, const Settings& settings) {
  try {
    require_whole_run(run_folder);
  } catch (const InputError& error) {
    throw FileError(run_folder, std::string("is damaged: ") + error.what());
  }
  Settings asked = settings;
  const RunFiles files(run_folder);
  const bool is_of_plan = files.has("config.yaml") && !files.has("edits.json") &&
                          files.sha256("config.yaml") == Sha256().update(config_text(option_table(asked))).hex();
  if (!is_of_plan)
    throw FileError(run_folder, std::string("is a run of other settings than the plan's, or was edited") + kRemoveIt);
}

std::string said_in_atlas(const std::string& message) {
  const std::size_t advice = message.find(kMapAgain);
  return advice == std::string::npos ? message : message.substr(0, advice) + kRemoveIt;
}

}  // namespace gdtslam
