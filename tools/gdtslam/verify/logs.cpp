#include "run.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/drive/cloud_output.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr const char* kSampleExpected = "office-start.json";
constexpr const char* kNoddingExpected = "nodding-start.json";

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// Throws nlohmann's exception if a key is missing or of another type.
SampleLog sample_in(const Json& root, const std::string& log) {
  SampleLog sample{log, {}};
  if (root.at("format") != kFormat) throw InputError("is of another format than this program reads");
  if (root.at("log") != file_name(log)) throw InputError("is not of " + file_name(log));
  if (root.at("log_sha256") != sha256_of_file(log).sha256) throw InputError("is not of this " + file_name(log));
  for (const Json& run : root.at("runs")) {
    sample.runs.push_back({.matcher = run.at("matcher"),
                           .with_loops = run.at("loops"),
                           .scans = run.at("scans"),
                           .map_sha256 = run.at("map_sha256"),
                           .trajectory_sha256 = run.at("trajectory_sha256"),
                           .cloud_sha256 = run.at("cloud_sha256")});
  }
  return sample;
}

// Whether the device's cells equal the host's copy.
bool copy_is_equal(Mapper& mapper) { return mapper.download_device_cells() == mapper.field().download(); }

void compare(const std::string& what, const std::string& expected, const std::string& found, const std::string& whose,
             std::vector<std::string>& faults) {
  if (expected != found)
    faults.push_back(what + " " + found.substr(0, 12) + ", " + whose + " " + expected.substr(0, 12));
}

SampleLog read_sample(const std::string& log, const char* results) {
  const std::string expected = asset_file("expected", results);
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  const Json root = read_json(expected, kMostBytes, "; install gdtslam again");
  try {
    return sample_in(root, log);
  } catch (const Json::exception&) {
    throw InputError({expected, 0}, "is damaged; install gdtslam again");
  } catch (const InputError& error) {
    throw InputError({expected, 0}, std::string(error.what()) + "; install gdtslam again");
  }
}

// Passes each scan through the mapper.
LogRun run_mapper(const LogTask& task, Backend& backend, const LogProgress& progress) {
  const Settings settings = load_settings({.file = {}, .sets = {"match.matcher=" + task.matcher}});
  ScanStream scans({task.log}, task.read, {});
  Mapper mapper(settings.mapper, backend, {.fall_back = false, .cpu = {}, .warn = {}});
  Trajectory trajectory;
  while (const std::optional<ScanRecord> record = scans.next()) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is kept of this verification");
    const MatchResult result = mapper.process(record->scan, record->T_odom_base);
    trajectory.push_back({result.stamp_s, result.T_map_base});
    progress(trajectory.size(), scans.progress());
  }
  if (mapper.statistics().keyframes == 0) {
    throw InputError({task.log, 0}, trajectory.empty() ? "holds no laser scan to map"
                                                       : nothing_mappable(trajectory.size(), settings.mapper.scan));
  }
  LogRun run;
  run.scans = trajectory.size();
  run.copy_is_equal = copy_is_equal(mapper);
  run.map_sha256 = sha256_of(rows_of(mapper.field()));
  run.trajectory_sha256 = sha256_of(trajectory);
  return run;
}

// Runs the whole of `map`, with its loops closed. The points of a nodding laser go to a temporary file.
LogRun run_with_loops(const LogTask& task, Backend& backend, const LogProgress& progress) {
  const Settings settings = load_settings({.file = {}, .sets = {"match.matcher=" + task.matcher}});
  ScanStream scans({task.log}, task.read, {});
  const MapRequest request{.logs = {task.log},
                           .settings = settings,
                           .with_map = false,
                           .with_pictures = false,
                           .on_failure = {.fall_back = false, .cpu = {}, .warn = {}}};
  NoddingJob nodding;
  nodding.kind = scans.nod_kind(ScanStream::kMostAhead);
  const bool nods = nodding.kind != NodKind::kNone;
  const TemporaryFolder folder("gdtslam-verify");
  std::unique_ptr<CloudOutput> cloud;
  if (nods) {
    const std::string linkage = linkage_sidecar(task.log);
    nodding.model = resolve_linkage(linkage.empty() ? std::string(calib::kDefaultLinkage) : linkage);
    cloud = std::make_unique<CloudOutput>(settings.cloud, folder.path() + "/cloud.ply");
  }
  MapRun mapping(request, backend, std::move(scans), nods ? &nodding : nullptr, std::move(cloud));
  const MapOutcome outcome = mapping.run(progress, [] { return interrupted(); });
  if (outcome.interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing is kept of this verification");
  LogRun run;
  run.scans = outcome.trajectory.size();
  run.copy_is_equal = true;
  run.map_sha256 = sha256_of(rows_of(mapping.field()));
  run.trajectory_sha256 = sha256_of(outcome.trajectory);
  if (nods) run.cloud_sha256 = outcome.nodding->cloud.sha256;
  return run;
}

}  // namespace

std::vector<SampleLog> sample_logs() {
  return {read_sample(sample_log_file(), kSampleExpected), read_sample(nodding_sample_log_file(), kNoddingExpected)};
}
void write_expected(const std::string& path, const std::string& log, const std::vector<ExpectedRun>& runs) {
  Json list = Json::array();
  for (const ExpectedRun& run : runs) {
    list.push_back({{"matcher", run.matcher},
                    {"loops", run.with_loops},
                    {"scans", run.scans},
                    {"map_sha256", run.map_sha256},
                    {"trajectory_sha256", run.trajectory_sha256},
                    {"cloud_sha256", run.cloud_sha256}});
  }
  write_json(
      path, {{"format", kFormat}, {"log", file_name(log)}, {"log_sha256", sha256_of_file(log).sha256}, {"runs", list}});
}

LogRun run_log(const LogTask& task, Backend& backend, const LogProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t dispatches = backend.dispatch_count();
  const std::uint64_t submissions = backend.submit_count();
  LogRun run = task.with_loops ? run_with_loops(task, backend, progress) : run_mapper(task, backend, progress);
  run.dispatches = backend.dispatch_count() - dispatches;
  run.submissions = backend.submit_count() - submissions;
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run;
}

LogVerdict judge(const LogTask& task, const LogRun& reference, const LogRun& found) {
  LogVerdict verdict{task, reference, found, {}};
  compare("map", reference.map_sha256, found.map_sha256, "on the CPU", verdict.faults);
  compare("trajectory", reference.trajectory_sha256, found.trajectory_sha256, "on the CPU", verdict.faults);
  compare("cloud", reference.cloud_sha256, found.cloud_sha256, "on the CPU", verdict.faults);
  if (!found.copy_is_equal) verdict.faults.emplace_back("the host's copy of the map is not what the device holds");
  if (!task.expected) return verdict;
  if (task.expected->scans != found.scans) verdict.faults.emplace_back("another number of scans than shipped");
  compare("map", task.expected->map_sha256, found.map_sha256, "shipped", verdict.faults);
  compare("trajectory", task.expected->trajectory_sha256, found.trajectory_sha256, "shipped", verdict.faults);
  compare("cloud", task.expected->cloud_sha256, found.cloud_sha256, "shipped", verdict.faults);
  return verdict;
}

}  // namespace gdtslam
