#include "run_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "report_reader.hpp"
#include "run_folder.hpp"
#include "run_pictures.hpp"
#include "run_report.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kCloud = "cloud.ply";
constexpr const char* kLinkage = "linkage.yaml";
constexpr const char* kCovariances = "covariance.csv";
constexpr const char* kConfig = "config.yaml";
constexpr const char* kTrajectory = "trajectory.tum";
constexpr const char* kGraph = "graph.g2o";

RunSummary read_summary(const ReportReader& report) {
  RunSummary summary;
  summary.logs = report.texts("log");
  summary.scans = report.whole("scans");
  summary.matched = report.whole("matched");
  summary.keyframe_count = report.whole("keyframes");
  summary.path_m = report.number("path_m");
  summary.cloud_points = report.whole("cloud_points");
  if (report.has("map")) summary.map = report.geometry("map");
  if (report.has("tiles")) summary.tiles = report.whole("tiles");
  summary.map_sha256 = report.text("map_sha256");
  if (report.has("keyframes_sha256")) summary.keyframes_sha256 = report.text("keyframes_sha256");
  summary.nods = report.has("nodding");
  summary.has_loops = report.has("loops");
  if (summary.nods) {  // reports of older versions do not say by what
    const ReportReader nodding = report.section("nodding");
    summary.tilts = nodding.has("told_by") && nodding.text("told_by") == "TILT";
  }
  summary.doubtful = report.indices("doubtful_scans", "index", summary.scans);
  if (report.has("keyframe_scans")) {
    summary.keyframes = report.indices("keyframe_scans", nullptr, summary.scans);
  }
  if (report.has("drives")) {
    summary.drives = report.indices("drives", nullptr, summary.scans);
    if (!std::is_sorted(summary.drives.begin(), summary.drives.end())) report.fail("drives", "does not ascend");
  }
  return summary;
}

}  // namespace

bool RunReader::is_run(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) && fs::is_regular_file(fs::path(path) / kReportFile, ignored);
}

bool RunReader::is_broken_run(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored) || is_run(path)) return false;
  const auto has = [&](const char* name) { return fs::exists(fs::path(path) / name, ignored); };
  return has("keyframes.bin.gz") || (has("gdt.yaml") && has(kTrajectory));
}

bool RunReader::is_gdtslam_run(const std::string& path) {
  if (!is_run(path)) return false;
  try {
    const Json report = read_json((fs::path(path) / kReportFile).string(), kMostReportBytes, "");
    return report.is_object() && report.contains("format") && report.contains("map_sha256");
  } catch (const InputError&) {  // a report of somebody else
    return false;
  }
}

RunReader::RunReader(std::string folder)
    : files_(std::move(folder), [this](const ReportReader& report) { summary_ = read_summary(report); }) {}

RunDoubts RunReader::doubts() const { return read_doubts(files_.report(), summary_.scans); }

std::string RunReader::name() const { return run_title(summary_.logs); }

bool RunReader::has_trajectory() const { return files_.has(kTrajectory); }

void RunReader::refuse(const char* name, const std::string& fault) const {
  throw InputError({files_.path(name), 0}, fmt::format("{}: not of one run{}{}", fault, kMapAgain, folder()));
}

Trajectory RunReader::trajectory() const {
  Trajectory trajectory = files_.read(kTrajectory, [](const std::string& file) { return read_tum(file); });
  if (trajectory.size() != summary_.scans) {
    refuse(kTrajectory,
           fmt::format("has {} poses, but {} tells of {} scans", trajectory.size(), kReportFile, summary_.scans));
  }
  return trajectory;
}

std::optional<std::vector<PoseCovariance>> RunReader::covariances() const {
  if (!files_.has(kCovariances)) return std::nullopt;
  const std::vector<StampedCovariance> rows = files_.read(kCovariances, read_covariances);
  if (rows.size() != summary_.scans) {
    refuse(kCovariances,
           fmt::format("has {} rows, but {} tells of {} scans", rows.size(), kReportFile, summary_.scans));
  }
  std::vector<PoseCovariance> covariances;
  covariances.reserve(rows.size());
  for (const StampedCovariance& row : rows) covariances.push_back(row.covariance);
  return covariances;
}

GraphLines RunReader::graph() const {
  if (!files_.is_told()) return read_graph(files_.path(kGraph));
  return files_.read(kGraph, read_graph);
}

OccupancyMap RunReader::map() const {
  if (!summary_.map) {
    throw InputError({folder(), 0},
                     "has no occupancy map: it was mapped with --no-map; map the log again without that option");
  }
  (void)files_.checked("map.pgm");
  return files_.read("map.yaml", [](const std::string& file) { return read_occupancy_map(file); });
}

DistanceFieldFile RunReader::field() const {
  if (summary_.tiles > 0 && !files_.has("gdt.png")) {
    throw InputError({folder(), 0},
                     "has its map in tiles, and no distance field of all of it: cut a piece out with 'gdtslam edit RUN "
                     "--crop X0,Y0,X1,Y1 -o PART'");
  }
  (void)files_.checked("gdt.png");
  return files_.read("gdt.yaml", [](const std::string& file) { return read_distance_field(file); });
}

Settings RunReader::settings() const {
  Settings settings;
  settings.from_file =
      files_.read(kConfig, [&](const std::string& file) { return read_config(file, option_table(settings)); });
  return settings;
}

std::optional<RunKeyframes> RunReader::keyframes() const {
  if (!summary_.keyframes_sha256) return std::nullopt;
  RunKeyframes read = files_.read(kKeyframeFile, read_keyframes);
  const auto is_scan = [](const RunKeyframe& keyframe, std::size_t scan) { return keyframe.scan == scan; };
  if (!std::ranges::equal(read.keyframes, summary_.keyframes, is_scan)) {
    refuse(kReportFile, fmt::format("has other keyframe_scans than {}", kKeyframeFile));
  }
  return read;
}

std::optional<std::string> RunReader::cloud_file() const {
  if (summary_.cloud_points == 0) return std::nullopt;
  return files_.checked(kCloud);
}

std::optional<calib::SweepModel> RunReader::linkage() const {
  if (!summary_.nods || !files_.has(kLinkage)) return std::nullopt;
  return files_.read(kLinkage, [](const std::string& file) { return read_linkage(file); });
}

}  // namespace gdtslam
