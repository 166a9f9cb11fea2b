#include "run_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "report_reader.hpp"
#include "run_pictures.hpp"
#include "run_report.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kReport = "report.json";
constexpr const char* kCloud = "cloud.ply";
constexpr const char* kLinkage = "linkage.yaml";
constexpr const char* kCovariances = "covariance.csv";
constexpr const char* kConfig = "config.yaml";

std::string sha256_of_file(const std::string& path) {
  return Sha256().update(read_all(*open_file_source(path), kMaxYamlBytes, path)).hex();
}

}  // namespace

bool RunReader::is_run(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) && fs::is_regular_file(fs::path(path) / kReport, ignored);
}

bool RunReader::is_gdtslam_run(const std::string& path) {
  if (!is_run(path)) return false;
  try {
    const Json report = read_json((fs::path(path) / kReport).string(), kMostReportBytes, "");
    return report.is_object() && report.contains("format") && report.contains("map_sha256");
  } catch (const InputError&) {  // a report of somebody else
    return false;
  }
}

RunReader::RunReader(std::string folder) : folder_(std::move(folder)) {
  if (!is_run(folder_)) {
    throw InputError({folder_, 0}, fmt::format("is no folder of a run: it has no {}{}{}", kReport, kMapAgain, folder_));
  }
  const ReportReader report = read_report(file(kReport), folder_);
  summary_.logs = report.texts("log");
  summary_.scans = report.whole("scans");
  summary_.matched = report.whole("matched");
  summary_.keyframe_count = report.whole("keyframes");
  summary_.path_m = report.number("path_m");
  summary_.cloud_points = report.whole("cloud_points");
  if (report.has("map")) summary_.map = report.geometry("map");
  summary_.map_sha256 = report.text("map_sha256");
  if (report.has("keyframes_sha256")) summary_.keyframes_sha256 = report.text("keyframes_sha256");
  summary_.nods = report.has("nodding");
  summary_.has_loops = report.has("loops");
  summary_.tilts = summary_.nods && report.has_member("nodding", "told_by", "TILT");
  if (report.has("match_p99_m")) summary_.match_p99_m = report.number("match_p99_m");
  summary_.doubtful = report.indices("doubtful_scans", "index", summary_.scans);
  if (report.has("keyframe_scans")) {
    summary_.keyframes = report.indices("keyframe_scans", nullptr, summary_.scans);
  }
  if (report.has("drives")) summary_.drives = report.indices("drives", nullptr, summary_.scans);
}

RunDoubts RunReader::doubts() const { return doubts_of(read_report(file(kReport), folder_), summary_.scans); }

std::string RunReader::file(const char* name) const { return (fs::path(folder_) / name).string(); }

void RunReader::require(const char* name) const {
  std::error_code ignored;
  if (fs::exists(fs::path(folder_) / name, ignored)) return;
  throw InputError({file(name), 0}, fmt::format("is missing in this run{}{}", kMapAgain, folder_));
}

std::string RunReader::name() const { return run_title(summary_.logs); }

bool RunReader::has_trajectory() const {
  std::error_code ignored;
  return fs::exists(file("trajectory.tum"), ignored);
}

void RunReader::refuse(const char* name, const std::string& fault) const {
  throw InputError({file(name), 0}, fmt::format("{}: not of one run{}{}", fault, kMapAgain, folder_));
}

Trajectory RunReader::trajectory() const {
  require("trajectory.tum");
  Trajectory trajectory = read_tum(file("trajectory.tum"));
  if (trajectory.size() != summary_.scans) {
    refuse("trajectory.tum",
           fmt::format("has {} poses, but {} tells of {} scans", trajectory.size(), kReport, summary_.scans));
  }
  return trajectory;
}

std::optional<std::vector<PoseCovariance>> RunReader::covariances() const {
  std::error_code ignored;
  if (!fs::exists(file(kCovariances), ignored)) return std::nullopt;
  const std::vector<StampedCovariance> rows = read_covariances(file(kCovariances));
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

OccupancyMap RunReader::map() const {
  if (!summary_.map) {
    throw InputError({folder_, 0},
                     "has no occupancy map: it was mapped with --no-map; map the log again without that option");
  }
  require("map.yaml");
  require("map.pgm");
  OccupancyMap map = read_occupancy_map(file("map.yaml"));
  const auto as_text = [](const GridGeometry& grid) {
    return fmt::format("{} x {} cells of {} m from ({}, {})", grid.width, grid.height, grid.resolution_m,
                       grid.origin_x_m, grid.origin_y_m);
  };
  if (map.geometry != *summary_.map) {
    refuse("map.yaml",
           fmt::format("has {}, but {} tells of {}", as_text(map.geometry), kReport, as_text(*summary_.map)));
  }
  return map;
}

DistanceFieldFile RunReader::field() const {
  require("gdt.yaml");
  require("gdt.png");
  DistanceFieldFile field = read_distance_field(file("gdt.yaml"));
  if (sha256_of(rows_of(field.view())) != summary_.map_sha256) {
    refuse("gdt.png", fmt::format("is not the distance field that {} tells of", kReport));
  }
  return field;
}

Settings RunReader::settings() const {
  require(kConfig);
  Settings settings;
  settings.from_file = read_config(file(kConfig), option_table(settings));
  return settings;
}

std::optional<RunKeyframes> RunReader::keyframes() const {
  if (!summary_.keyframes_sha256) return std::nullopt;
  require(kKeyframeFile);
  KeyframeFile read = read_keyframes(file(kKeyframeFile));
  if (read.sha256 != *summary_.keyframes_sha256) {
    refuse(kKeyframeFile, fmt::format("holds other keyframes than {} tells of", kReport));
  }
  const auto is_scan = [](const RunKeyframe& keyframe, std::size_t scan) { return keyframe.scan == scan; };
  if (!std::ranges::equal(read.run.keyframes, summary_.keyframes, is_scan)) {
    refuse(kReport, fmt::format("has other keyframe_scans than {}", kKeyframeFile));
  }
  require(kConfig);
  if (sha256_of_file(file(kConfig)) != read.run.config_sha256) {
    refuse(kConfig, fmt::format("is not the configuration that {} was mapped with", kKeyframeFile));
  }
  return std::move(read.run);
}

std::optional<std::string> RunReader::cloud_file() const {
  if (summary_.cloud_points == 0) return std::nullopt;
  require(kCloud);
  return file(kCloud);
}

std::optional<calib::SweepModel> RunReader::linkage() const {
  std::error_code ignored;
  if (!summary_.nods || !fs::exists(fs::path(folder_) / kLinkage, ignored)) return std::nullopt;
  return read_linkage(file(kLinkage));
}

}  // namespace gdtslam
