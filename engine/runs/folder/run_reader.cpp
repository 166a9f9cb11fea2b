#include "run_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"

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
  if (summary.nods) {  // reports of older versions do not name the messages
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
  } catch (const InputError&) {  // a report of another program
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
  const Trajectory poses = trajectory();
  if (rows.size() != poses.size()) {
    refuse(kCovariances, fmt::format("has {} rows, but trajectory.tum has {} poses", rows.size(), poses.size()));
  }
  std::vector<PoseCovariance> covariances;
  covariances.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].stamp_s != poses[i].stamp_s) {
      refuse(kCovariances, fmt::format("row {} is of {} s, but pose {} of trajectory.tum is of {} s", i + 1,
                                       rows[i].stamp_s, i + 1, poses[i].stamp_s));
    }
    covariances.push_back(rows[i].covariance);
  }
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

namespace {

/// The file and the run that are read, for messages.
struct GraphOfRun {
  std::string file;
  std::string folder;
  [[noreturn]] void refuse(const std::string& fault) const {
    throw InputError({file, 0}, fmt::format("{}: not of one run{}{}", fault, kMapAgain, folder));
  }
};

Matrix3 to_matrix(const PoseInformation& i, double factor) {
  return factor * Matrix3{{i.xx, i.xy, i.xt, i.xy, i.yy, i.yt, i.xt, i.yt, i.tt}};
}

std::size_t place_of_scan(const std::vector<std::size_t>& scans, std::size_t scan, const GraphOfRun& source) {
  const auto found = std::lower_bound(scans.begin(), scans.end(), scan);
  if (found == scans.end() || *found != scan)
    source.refuse(fmt::format("has an edge of scan {}, but no such vertex", scan));
  return static_cast<std::size_t>(found - scans.begin());
}

PoseRelation relation_of_line(const PathRelation& line, double factor, const std::vector<std::size_t>& scans,
                              const GraphOfRun& source) {
  return {.from = place_of_scan(scans, line.from, source),
          .to = place_of_scan(scans, line.to, source),
          .T_from_to = line.T_from_to,
          .information = to_matrix(line.information, factor)};
}

void check_path(const PoseGraph& graph, const GraphOfRun& source) {
  std::vector<bool> is_known(graph.poses.size(), false);
  for (const PoseRelation& step : graph.path) {
    if (step.to != step.from + 1)
      source.refuse("has an edge that is neither a step of the path nor a loop of the report");
    is_known[step.from] = true;
  }
  if (std::find(is_known.begin(), is_known.end() - 1, false) != is_known.end() - 1) {
    source.refuse("has no edge from one of its places to the next");
  }
}

std::vector<std::size_t> scans_of_places(const GraphLines& lines, const RunReader& run, const GraphOfRun& source) {
  std::vector<std::size_t> scans;
  scans.reserve(lines.places.size());
  for (const GraphPlace& place : lines.places) {
    if (place.scan >= run.summary().scans || (!scans.empty() && place.scan <= scans.back())) {
      source.refuse(
          fmt::format("has vertex {} of {} scans, or not in the order of the path", place.scan, run.summary().scans));
    }
    scans.push_back(place.scan);
  }
  return scans;
}

}  // namespace

RunGraph read_run_graph(const RunReader& run) {
  const GraphOfRun source{(std::filesystem::path(run.folder()) / "graph.g2o").string(), run.folder()};
  if (!run.files().has("graph.g2o")) {
    throw InputError({source.file, 0}, fmt::format("is missing in this run{}{}", kMapAgain, source.folder));
  }
  if (!run.summary().drives.empty()) {
    throw InputError({source.file, 0}, "is of a site, whose drives do not make up one path");
  }
  const std::vector<ClosedLoop> told = run.doubts().loops.value_or(LoopFindings()).loops;
  const GraphLines lines = run.graph();
  if (lines.places.empty()) source.refuse("has no places");
  if (lines.relations.size() < told.size()) source.refuse("has fewer edges than the report has loops");
  RunGraph result;
  result.scans = scans_of_places(lines, run, source);
  result.graph.poses.reserve(lines.places.size());
  for (const GraphPlace& place : lines.places) result.graph.poses.push_back(place.T_map_base);
  const std::size_t steps = lines.relations.size() - told.size();
  result.graph.path.reserve(steps);
  result.graph.loops.reserve(told.size());
  result.is_on.reserve(told.size());
  for (std::size_t i = 0; i < lines.relations.size(); ++i) {
    const PathRelation& line = lines.relations[i];
    if (i < steps) {
      result.graph.path.push_back(relation_of_line(line, 1.0, result.scans, source));
      continue;
    }
    const ClosedLoop& loop = told[i - steps];
    if (line.from != loop.from || line.to != loop.to) {
      source.refuse(fmt::format("has an edge from scan {} to {} where the report has a loop from {} to {}", line.from,
                                line.to, loop.from, loop.to));
    }
    const double by_itself = loop.weight > 0.0 ? 1.0 / loop.weight : 0.0;
    result.graph.loops.push_back({relation_of_line(line, by_itself, result.scans, source), loop.weight});
    result.is_on.push_back(loop.is_on);
  }
  check_path(result.graph, source);
  return result;
}

namespace {

namespace fs = std::filesystem;

bool is_folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// The file of that name in another program's folder.
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
