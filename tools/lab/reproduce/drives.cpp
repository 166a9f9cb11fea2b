#include "drives.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "store.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"
#include "tools/gdtslam/scenes/simulate_run.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;

// Along the corridor of office-3f: the open elevator ahead and to the left, a plant ahead. In office-loop: a crossing.
constexpr std::string_view kAtElevator = "gdtslam_trajectory: 1\nwaypoints:\n  - {at: [10.5, 4.7], pause: 40 s}\n";
constexpr std::string_view kAtPlant = "gdtslam_trajectory: 1\nwaypoints:\n  - {at: [18.8, 4.7], pause: 40 s}\n";
constexpr std::string_view kAtCrossing = "gdtslam_trajectory: 1\nwaypoints:\n  - {at: [18.9, 6.1], pause: 1 s}\n";

// What a simulation takes of the time of simulation and map.
constexpr double kSimulationShare = 0.35;

// Of a folder with the mark: whether nothing else is in it.
bool holds_its_mark_alone(const std::string& folder) {
  std::error_code failed;
  return list_folder(folder, failed).size() == 1 && !failed;
}

[[noreturn]] void throw_interrupted() { throw Error(ExitCode::kInterrupted, "interrupted"); }

}  // namespace

const DriveRecipe& recipe_of(std::string_view name) {
  static const std::vector<DriveRecipe> recipes{
      {.name = "office-loop", .scene = "office-loop"},
      {.name = "office-loop-matched", .scene = "office-loop", .with_loops = false, .weight_s = 0.5},
      {.name = "office-loop-2", .scene = "office-loop", .is_mapped = false, .seed = 2},
      {.name = "office-loop-3", .scene = "office-loop", .is_mapped = false, .seed = 3},
      {.name = "one-scan",
       .scene = "office-loop",
       .waypoints = kAtCrossing,
       .sets = {"occupancy.min_ends=1"},
       .laser = "hokuyo-961",
       .first = 1},
      {.name = "three-boxes", .scene = "three-boxes", .sets = {"cloud.voxel=0"}, .weight_s = 1.2},
      {.name = "at-elevator",
       .scene = "office-3f",
       .waypoints = kAtElevator,
       .sets = {"cloud.voxel=0"},
       .weight_s = 1.2},
      {.name = "at-plant", .scene = "office-3f", .waypoints = kAtPlant, .sets = {"cloud.voxel=0"}, .weight_s = 1.2},
      {.name = "office-3f", .scene = "office-3f", .weight_s = 7.0},
      {.name = "office-7f", .scene = "office-7f", .weight_s = 8.5},
      {.name = "wall", .scene = "wall", .is_mapped = false, .linkage = "paper-b-calibrated"},
  };
  for (const DriveRecipe& recipe : recipes) {
    if (recipe.name == name) return recipe;
  }
  throw Error(ExitCode::kFailed, fmt::format("there is no drive '{}'", name));
}

Drives::Drives(std::string folder, std::string program, DeviceOptions device, std::function<bool()> stop)
    : folder_(std::move(folder)), program_(std::move(program)), device_(std::move(device)), stop_(std::move(stop)) {}

std::string Drives::key_of(std::string_view name) {
  const DriveRecipe& recipe = recipe_of(name);
  Sha256 key;
  key.update(recipe.name).update(read_text<InputError>(find_scene(std::string(recipe.scene), asset_folders("scenes"))));
  key.update(recipe.waypoints).update(recipe.is_mapped ? "mapped" : "log").update(fmt::format("seed {}", recipe.seed));
  key.update(recipe.laser).update(recipe.linkage).update(fmt::format("first {}", recipe.first));
  for (const std::string& set : recipe.sets) key.update(set);
  key.update(recipe.with_loops ? "loops" : "no loops");
  return key.hex();
}

std::vector<std::string> Drives::commands_of(std::string_view name) {
  const DriveRecipe& recipe = recipe_of(name);
  std::vector<std::string> commands;
  std::string simulation = fmt::format("gdtslam simulate {} -o {}.log", recipe.scene, name);
  if (!recipe.waypoints.empty()) {
    commands.push_back(fmt::format("printf '{}' > {}.yaml", recipe.waypoints, name));
    for (std::size_t at = 0; (at = commands.back().find('\n', at)) != std::string::npos;)
      commands.back().replace(at, 1, "\\n");
    simulation += fmt::format(" --trajectory {}.yaml", name);
  }
  if (recipe.seed != kSeed) simulation += fmt::format(" --seed {}", recipe.seed);
  if (!recipe.laser.empty()) simulation += fmt::format(" --laser {}", recipe.laser);
  if (!recipe.linkage.empty()) simulation += fmt::format(" --linkage {}", recipe.linkage);
  commands.push_back(simulation);
  if (!recipe.is_mapped) return commands;
  std::string map = fmt::format("gdtslam map {0}.log -o {0}", name);
  for (const std::string& set : recipe.sets) map += " --set " + set;
  if (recipe.first > 0) map += fmt::format(" --first {}", recipe.first);
  if (!recipe.with_loops) map += " --no-loops";
  commands.push_back(map);
  return commands;
}

std::string Drives::folder_of(std::string_view name) const { return fmt::format("{}/{}", folder_, name); }

std::string Drives::mark_of(std::string_view name) const { return key_of(name) + program_ + device_.device + "\n"; }

bool Drives::is_made(std::string_view name) const {
  const std::string mark = folder_of(name) + "/key";
  std::error_code failed;
  return fs::exists(mark, failed) && read_text<InputError>(mark) == mark_of(name);
}

Drive Drives::drive(std::string_view name) const {
  const DriveRecipe& recipe = recipe_of(name);
  const std::string folder = folder_of(name);
  return {fmt::format("{}/{}.log", folder, name), fmt::format("{}/{}.truth.tum", folder, name),
          recipe.is_mapped ? folder + "/run" : "", find_scene(std::string(recipe.scene), asset_folders("scenes"))};
}

void Drives::make(std::string_view name, const std::function<void(double)>& progress) const {
  const DriveRecipe& recipe = recipe_of(name);
  const Drive made = drive(name);
  const std::string folder = folder_of(name);
  make_marked_folder(folder);
  const double simulated_share = recipe.is_mapped ? kSimulationShare : 1.0;
  simulate_drive(recipe, made, folder, [&](double share) { progress(simulated_share * share); });
  if (recipe.is_mapped) {
    const auto map_progress = [&](double share) { progress(simulated_share + (1.0 - simulated_share) * share); };
    map_whole(made.log, made.run, device_, map_progress,
              {.sets = recipe.sets, .first = recipe.first, .with_loops = recipe.with_loops});
  }
  write_file_atomically(folder + "/key", mark_of(name));
}

void Drives::simulate_drive(const DriveRecipe& recipe, const Drive& drive, const std::string& folder,
                            const std::function<void(double)>& progress) const {
  SimulateOptions simulation{.scene = drive.scene, .scene_folders = {}, .output = drive.log, .seed = recipe.seed};
  if (!recipe.waypoints.empty()) {
    simulation.trajectory = folder + "/waypoints.yaml";
    write_file_atomically(*simulation.trajectory, recipe.waypoints);
  }
  if (!recipe.laser.empty()) simulation.laser = std::string(recipe.laser);
  if (!recipe.linkage.empty()) simulation.linkage = std::string(recipe.linkage);
  simulation.progress = [&](std::uint64_t, double share) { progress(share); };
  simulation.stop = stop_;
  if (!simulate(simulation).is_whole) throw_interrupted();
}

void Drives::require_own(std::string_view name) const { require_own_folder(folder_of(name)); }

void Drives::prepare() const {
  std::error_code failed;
  if (!fs::exists(folder_, failed)) make_marked_folder(folder_);
}

void Drives::clear() const {
  std::error_code failed;
  for (const fs::path& entry : list_folder(folder_, failed)) {
    if (is_marked_folder(entry.string())) remove_own_folder(entry.string());
  }
  if (failed && failed != std::errc::no_such_file_or_directory)
    throw FileError(folder_, "cannot be listed: " + failed.message());
  if (is_marked_folder(folder_) && holds_its_mark_alone(folder_)) remove_own_folder(folder_);
}

void map_whole(const std::string& log, const std::string& run, const DeviceOptions& device,
               const std::function<void(double)>& progress, const MapChoices& choices) {
  MapRequest request{.logs = {log}, .folder = run, .settings = load_settings({.file = "", .sets = choices.sets})};
  if (choices.first > 0) request.range.count = choices.first;
  request.with_loops = choices.with_loops;
  request.with_pictures = false;
  request.with_continue_file = false;
  request.on_failure = on_failure_of(device);
  request.progress = [&](std::uint64_t, double share) { progress(share); };
  request.stop = [] { return interrupted(); };
  BackendWhenNeeded backend(device);
  const auto backend_of = [&backend](bool has_work) -> Backend& { return backend.of(has_work); };
  if (map_logs(request, backend_of).outcome.interrupted) throw_interrupted();
}

ReferenceReport errors_of(const Drive& drive, bool is_aligned) {
  return evaluate_reference(read_tum(drive.run + "/trajectory.tum"), read_tum(drive.truth), {.align = is_aligned});
}

std::vector<RealLog> real_logs(const std::string& folder) {
  if (folder.empty()) return {};
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) throw FileError(folder, "there is no such folder of real logs");
  constexpr std::array<std::array<const char*, 2>, 3> kKnown{
      {{"Intel Research Lab", "intel"}, {"Freiburg 079", "fr079"}, {"MIT CSAIL", "mit-csail"}}};
  for (const char* const below : {"", "/slam2d"}) {
    std::vector<RealLog> found;
    for (const auto& [name, stem] : kKnown) {
      const std::string start = folder + below + "/" + stem;
      if (fs::is_regular_file(start + ".clf.gz", failed) && fs::is_regular_file(start + ".relations.gz", failed))
        found.push_back({name, stem, start + ".clf.gz", start + ".relations.gz"});
    }
    if (!found.empty()) return found;
  }
  throw FileError(folder,
                  "holds none of intel.clf.gz, fr079.clf.gz and mit-csail.clf.gz with its NAME.relations.gz, nor does "
                  "slam2d in it");
}

}  // namespace gdtslam::reproduce
