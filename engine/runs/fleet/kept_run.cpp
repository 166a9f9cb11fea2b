#include "kept_run.hpp"

#include <filesystem>
#include <system_error>

#include "engine/core/files/file_state.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "record.hpp"

namespace gdtslam {
namespace {

constexpr const char* kRemoveIt = "; remove that folder and run its shard again";

}  // namespace

bool has_report(const std::string& atlas, const std::string& run) {
  return state_of_file(atlas + "/" + run_path(run) + "/" + kReportFile).has_value();
}

bool is_run_there(const std::string& run_folder) {
  std::error_code failed;
  if (!std::filesystem::exists(run_folder, failed)) return false;
  if (state_of_file(run_folder + "/" + kReportFile)) return true;
  const bool is_empty = std::filesystem::is_empty(run_folder, failed);
  if (is_empty && !failed && std::filesystem::is_directory(run_folder, failed)) return false;
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
