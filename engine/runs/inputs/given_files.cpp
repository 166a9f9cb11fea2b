#include "given_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <system_error>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool is_folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// The file of that name in a folder that is no run, as other programs leave it.
std::string file_of_folder(const std::string& folder, const char* name, const char* instead) {
  refuse_broken_run(folder, name);
  const fs::path file = fs::path(folder) / name;
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored)) return file.string();
  throw InputError({folder, 0}, fmt::format("is a folder without report.json, so no run of 'gdtslam map', and has no "
                                            "{}; give the folder of a run or {}",
                                            name, instead));
}

std::string why_no_cloud(const RunSummary& summary) {
  return summary.nods ? "it was mapped with --no-cloud; map the log again without that option"
                      : "'map' makes one where the laser nods, and 'merge' and 'edit' leave it out; give a run with "
                        "cloud.ply, or a cloud, .ply or .pcd";
}

Trajectory trajectory_in(const std::string& given) {
  if (!is_folder(given)) return read_tum(given);
  if (RunReader::is_run(given)) return RunReader(given).trajectory();
  return read_tum(file_of_folder(given, "trajectory.tum", "a trajectory, TUM"));
}

}  // namespace

void refuse_broken_run(const std::string& folder, const char* name) {
  refuse_folder_of_sites(folder);
  if (!RunReader::is_broken_run(folder)) return;
  throw InputError({folder, 0},
                   fmt::format("is a folder without report.json, so no run of 'gdtslam map', though files of one are "
                               "there: map again, or name {} in it itself if that is meant",
                               name));
}

Trajectory given_trajectory(const std::string& given) {
  Trajectory trajectory = trajectory_in(given);
  if (trajectory.empty()) throw InputError({given, 0}, "holds no pose; give a trajectory, TUM");
  return trajectory;
}

std::string given_cloud(const std::string& given) {
  std::optional<RunReader> ignored;
  return given_cloud(given, ignored);
}

std::string given_cloud(const std::string& given, std::optional<RunReader>& run) {
  run.reset();
  if (!is_folder(given)) return given;
  if (!RunReader::is_run(given)) return file_of_folder(given, "cloud.ply", "a cloud, .ply or .pcd");
  run.emplace(given);
  if (std::optional<std::string> file = run->cloud_file()) return *file;
  throw InputError({given, 0}, "this run has no cloud: " + why_no_cloud(run->summary()));
}

}  // namespace gdtslam
