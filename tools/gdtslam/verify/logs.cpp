#include "logs.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr const char* kSampleExpected = "office-start.json";

std::string sha256_of_file(const std::string& path) { return Sha256().update(read_text<InputError>(path)).hex(); }

std::string file_name_of(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// Throws nlohmann's exception where a key is missing or of another type.
SampleLog sample_in(const Json& root, const std::string& log) {
  SampleLog sample{log, {}};
  if (root.at("format") != kFormat) throw InputError("is of another format than this program reads");
  if (root.at("log") != file_name_of(log)) throw InputError("is not of " + file_name_of(log));
  if (root.at("log_sha256") != sha256_of_file(log)) throw InputError("is not of this " + file_name_of(log));
  for (const Json& run : root.at("runs")) {
    sample.runs.push_back({run.at("matcher"), run.at("scans"), run.at("map_sha256"), run.at("trajectory_sha256")});
  }
  return sample;
}

// Whether the device's cells are those of the host's copy; what lies between the rows does not count.
bool copy_is_equal(Mapper& mapper) {
  const DistanceFieldView copy = view_of(mapper.field());
  const std::vector<std::uint16_t> cells = mapper.download_device_cells();
  if (cells.size() != copy.cells.size()) return false;
  const auto width = static_cast<std::ptrdiff_t>(copy.geometry.width);
  for (std::size_t row = 0; row < cells.size(); row += copy.stride) {
    const auto first = static_cast<std::ptrdiff_t>(row);
    if (!std::equal(cells.begin() + first, cells.begin() + first + width, copy.cells.begin() + first)) return false;
  }
  return true;
}

void compare(const std::string& what, const std::string& expected, const std::string& found, const std::string& whose,
             std::vector<std::string>& faults) {
  if (expected != found)
    faults.push_back(what + " " + found.substr(0, 12) + ", " + whose + " " + expected.substr(0, 12));
}

}  // namespace

SampleLog sample_log() {
  const std::string log = sample_log_file();
  const std::string expected = asset_file("expected", kSampleExpected);
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

void write_expected(const std::string& path, const std::string& log, const std::vector<ExpectedRun>& runs) {
  Json list = Json::array();
  for (const ExpectedRun& run : runs) {
    list.push_back({{"matcher", run.matcher},
                    {"scans", run.scans},
                    {"map_sha256", run.map_sha256},
                    {"trajectory_sha256", run.trajectory_sha256}});
  }
  write_json(path,
             {{"format", kFormat}, {"log", file_name_of(log)}, {"log_sha256", sha256_of_file(log)}, {"runs", list}});
}

LogRun run_log(const LogTask& task, Backend& backend, const LogProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Settings settings = load_settings({.file = {}, .sets = {"match.matcher=" + task.matcher}});
  ScanStream scans({task.log}, {}, {});
  const std::uint64_t dispatches = backend.dispatch_count();
  const std::uint64_t submissions = backend.submit_count();
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
  run.map_sha256 = sha256_of(view_of(mapper.field()));
  run.trajectory_sha256 = sha256_of(trajectory);
  run.dispatches = backend.dispatch_count() - dispatches;
  run.submissions = backend.submit_count() - submissions;
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run;
}

LogVerdict judge(const LogTask& task, const LogRun& reference, const LogRun& found) {
  LogVerdict verdict{task, reference, found, {}};
  compare("map", reference.map_sha256, found.map_sha256, "on the CPU", verdict.faults);
  compare("trajectory", reference.trajectory_sha256, found.trajectory_sha256, "on the CPU", verdict.faults);
  if (!found.copy_is_equal) verdict.faults.emplace_back("the host's copy of the map is not what the device holds");
  if (!task.expected) return verdict;
  if (task.expected->scans != found.scans) verdict.faults.emplace_back("another number of scans than shipped");
  compare("map", task.expected->map_sha256, found.map_sha256, "shipped", verdict.faults);
  compare("trajectory", task.expected->trajectory_sha256, found.trajectory_sha256, "shipped", verdict.faults);
  return verdict;
}

}  // namespace gdtslam
