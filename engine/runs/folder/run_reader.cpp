#include "run_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "run_report.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kReport = "report.json";
constexpr const char* kCloud = "cloud.ply";
constexpr const char* kLinkage = "linkage.yaml";
constexpr std::size_t kMostReportBytes = std::size_t{80} << 20U;  // of a day of scans, all of them doubtful
constexpr const char* kMapAgain = "; map the log again: gdtslam map LOG -o ";

// A report as text that somebody may have edited: every key is asked for by name and type.
class ReportReader {
 public:
  ReportReader(const std::string& file, const std::string& folder)
      : file_(file), folder_(folder), report_(read_json(file, kMostReportBytes, kMapAgain + folder)) {
    if (!report_.is_object()) fail("holds no JSON object");
    const std::uint64_t format = whole("format");
    if (format != kReportVersion) {
      fail(fmt::format("has format {}, and this program reads format {}", format, kReportVersion));
    }
  }

  [[nodiscard]] std::uint64_t whole(const char* key) const {
    const Json& value = at(key);
    if (!value.is_number_unsigned()) fail(fmt::format("'{}' is no whole number", key));
    return value.get<std::uint64_t>();
  }
  [[nodiscard]] double number(const char* key) const {
    const Json& value = at(key);
    if (!value.is_number()) fail(fmt::format("'{}' is no number", key));
    return value.get<double>();
  }
  [[nodiscard]] std::string text(const char* key) const {
    const Json& value = at(key);
    if (!value.is_string()) fail(fmt::format("'{}' is no text", key));
    return value.get<std::string>();
  }
  [[nodiscard]] GridGeometry geometry(const char* key) const {
    try {
      const Json& value = at(key);
      const Json& origin = value.at("origin_m");
      return {.resolution_m = value.at("resolution_m").get<double>(),
              .origin_x_m = origin.at(0).get<double>(),
              .origin_y_m = origin.at(1).get<double>(),
              .width = value.at("width").get<std::int32_t>(),
              .height = value.at("height").get<std::int32_t>()};
    } catch (const Json::exception&) {
      fail(fmt::format("'{}' is no geometry of a grid", key));
    }
  }
  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> list;
    for (const Json& value : list_of(key)) {
      if (!value.is_string()) fail(fmt::format("'{}' is no list of texts", key));
      list.push_back(value.get<std::string>());
    }
    if (list.empty()) fail(fmt::format("'{}' is empty", key));
    return list;
  }
  [[nodiscard]] bool has(const char* key) const { return report_.contains(key); }
  // Of an object; false where it has no such member.
  [[nodiscard]] bool has_member(const char* key, const char* member, const char* text) const {
    const Json& object = at(key);
    if (!object.is_object()) fail(fmt::format("'{}' is no object", key));
    return object.contains(member) && object.at(member) == text;
  }
  // Whole numbers below `end`: entries of a list, or one member of each.
  [[nodiscard]] std::vector<std::size_t> indices(const char* key, const char* member, std::uint64_t end) const {
    std::vector<std::size_t> list;
    for (const Json& entry : list_of(key)) {
      const bool is_member = member != nullptr && entry.is_object() && entry.contains(member);
      const Json& value = is_member ? entry.at(member) : entry;
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= end) {
        fail(fmt::format("'{}' names a scan that is none of its {}", key, end));
      }
      list.push_back(value.get<std::size_t>());
    }
    return list;
  }

 private:
  [[nodiscard]] const Json& at(const char* key) const {
    const auto found = report_.find(key);
    if (found == report_.end()) fail(fmt::format("has no '{}'", key));
    return *found;
  }
  [[nodiscard]] const Json& list_of(const char* key) const {
    const Json& value = at(key);
    if (!value.is_array()) fail(fmt::format("'{}' is no list", key));
    return value;
  }
  [[noreturn]] void fail(const std::string& fault) const { throw InputError({file_, 0}, fault + kMapAgain + folder_); }

  std::string file_;
  std::string folder_;
  Json report_;
};

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
  const ReportReader report(file(kReport), folder_);
  summary_.logs = report.texts("log");
  summary_.scans = report.whole("scans");
  summary_.matched = report.whole("matched");
  summary_.keyframe_count = report.whole("keyframes");
  summary_.path_m = report.number("path_m");
  summary_.cloud_points = report.whole("cloud_points");
  summary_.map = report.geometry("map");
  summary_.map_sha256 = report.text("map_sha256");
  summary_.nods = report.has("nodding");
  summary_.tilts = summary_.nods && report.has_member("nodding", "told_by", "TILT");
  if (report.has("match_p99_m")) summary_.match_p99_m = report.number("match_p99_m");
  summary_.doubtful = report.indices("doubtful_scans", "index", summary_.scans);
  if (report.has("keyframe_scans")) {
    summary_.keyframes = report.indices("keyframe_scans", nullptr, summary_.scans);
  }
}

std::string RunReader::file(const char* name) const { return (fs::path(folder_) / name).string(); }

void RunReader::require(const char* name) const {
  std::error_code ignored;
  if (fs::exists(fs::path(folder_) / name, ignored)) return;
  throw InputError({file(name), 0}, fmt::format("is missing in this run{}{}", kMapAgain, folder_));
}

std::string RunReader::name() const {
  const std::string& log = summary_.logs.front();
  return log == "-" ? "stdin" : one_line(fs::path(sidecar_path(log, "")).filename().string(), 80);
}

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

OccupancyMap RunReader::map() const {
  require("map.yaml");
  require("map.pgm");
  OccupancyMap map = read_occupancy_map(file("map.yaml"));
  const auto as_text = [](const GridGeometry& grid) {
    return fmt::format("{} x {} cells of {} m from ({}, {})", grid.width, grid.height, grid.resolution_m,
                       grid.origin_x_m, grid.origin_y_m);
  };
  if (map.geometry != summary_.map) {
    refuse("map.yaml",
           fmt::format("has {}, but {} tells of {}", as_text(map.geometry), kReport, as_text(summary_.map)));
  }
  return map;
}

DistanceFieldFile RunReader::field() const {
  require("gdt.yaml");
  require("gdt.png");
  DistanceFieldFile field = read_distance_field(file("gdt.yaml"));
  if (sha256_of(field.view()) != summary_.map_sha256) {
    refuse("gdt.png", fmt::format("is not the distance field that {} tells of", kReport));
  }
  return field;
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
