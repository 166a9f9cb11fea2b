#include "continue_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/io/json_file.hpp"
#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/folder/run_doubts.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kContinueVersion = 1;
constexpr std::size_t kMostContinueBytes = std::size_t{16} << 20U;
constexpr std::array<std::string_view, 3> kNodNames{"none", "encoder", "tilt"};  // in the order of NodKind

Json topics_json(const TopicChoice& topics) {
  Json mounts = Json::array();
  for (const TopicMount& mount : topics.mounts) {
    const Pose2& pose = mount.T_base_laser;
    mounts.push_back({{"topic", mount.topic}, {"x_m", pose.x_m}, {"y_m", pose.y_m}, {"theta_rad", pose.theta_rad}});
  }
  Json json{{"odometry", topics.odometry}, {"crank", topics.crank}, {"mounts", std::move(mounts)}};
  if (!topics.scans.empty()) json["scans"] = topics.scans;
  return json;
}

TopicChoice topics_from(const ReportReader& file) {
  TopicChoice topics{.scans = file.has("scans") ? file.texts("scans") : std::vector<std::string>{},
                     .odometry = file.text("odometry"),
                     .crank = file.text("crank"),
                     .mounts = {}};
  for (const ReportReader& mount : file.entries("mounts")) {
    topics.mounts.push_back(
        {mount.text("topic"), {mount.number("x_m"), mount.number("y_m"), mount.number("theta_rad")}});
  }
  return topics;
}

Json prepared_json(const RunPreparation& prepared) {
  Json json{{"nods", kNodNames.at(static_cast<std::size_t>(prepared.nods))},
            {"linkage", prepared.linkage},
            {"linkage_yaml", prepared.linkage_yaml}};
  if (const std::optional<OdometryDelay>& delay = prepared.delay) {
    json["odometry_delay"] = {{"delay_s", delay->delay_s}, {"sigma_s", delay->sigma_s}};
  }
  if (!prepared.findings.empty()) json["findings"] = findings_json(prepared.findings);
  return json;
}

RunPreparation prepared_from(const ReportReader& file, const std::string& name) {
  RunPreparation prepared{
      .nods = NodKind::kNone, .linkage = file.text("linkage"), .linkage_yaml = file.text("linkage_yaml"), .delay = {}};
  prepared.findings = findings_from(file);
  const std::string nods = file.text("nods");
  const auto* const found = std::find(kNodNames.begin(), kNodNames.end(), nods);
  if (found == kNodNames.end()) throw InputError({name, 0}, "'nods' is none of none, encoder and tilt");
  prepared.nods = static_cast<NodKind>(found - kNodNames.begin());
  if (file.has("odometry_delay")) {
    const ReportReader delay = file.section("odometry_delay");
    prepared.delay = {.delay_s = delay.number("delay_s"), .sigma_s = delay.number("sigma_s")};
  }
  return prepared;
}

ScanRange range_from(const ReportReader& file) {
  ScanRange range{.skip = file.whole("skip")};
  if (file.has("first")) range.count = file.whole("first");
  return range;
}

// The program wrote it: what is no configuration is damage to the file.
Settings settings_from(const ReportReader& file, const std::string& name, const std::string& advice) {
  Settings settings;
  try {
    read_config_text(file.text("config_yaml"), name + " (its 'config_yaml')", option_table(settings));
    require_valid(settings);
  } catch (const ConfigError& error) {
    throw InputError(error.what() + advice);
  }
  settings.log.topics = topics_from(file.section("topics"));
  return settings;
}

}  // namespace

KeptRequest kept_request_of(const MapRequest& request) {
  KeptRequest kept{.request = {.logs = request.logs,
                               .settings = request.settings,
                               .lenient = request.lenient,
                               .range = request.range,
                               .linkage = request.linkage,
                               .with_cloud = request.with_cloud,
                               .with_map = request.with_map,
                               .with_loops = request.with_loops,
                               .with_pictures = request.with_pictures},
                   .paths = {}};
  kept.paths.reserve(request.logs.size());
  for (const std::string& log : request.logs) kept.paths.push_back(request.live_log ? "-" : absolute_path_of(log));
  return kept;
}

MapRequest restored(const MapRequest& request, const KeptRequest& kept) {
  MapRequest whole = request;
  const MapRequest& was = kept.request;
  whole.logs = was.logs;
  whole.settings = was.settings;
  whole.lenient = was.lenient;
  whole.range = was.range;
  whole.linkage = was.linkage;
  whole.with_cloud = was.with_cloud;
  whole.with_map = was.with_map;
  whole.with_loops = was.with_loops;
  whole.with_pictures = was.with_pictures;
  return whole;
}

std::string absolute_path_of(const std::string& log) {
  if (log == "-") return log;
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::absolute(log, failed);
  return failed ? log : path.string();
}

void write_continue_file(const std::string& file, const KeptRequest& kept) {
  const MapRequest& request = kept.request;
  Settings settings = request.settings;
  Json json = Json::object();
  json["format"] = kContinueVersion;
  json["version"] = GDTSLAM_VERSION;
  json["log"] = request.logs;
  json["path"] = kept.paths;
  json["lenient"] = request.lenient;
  json["skip"] = request.range.skip;
  if (request.range.count != ScanRange{}.count) json["first"] = request.range.count;
  json["linkage"] = request.linkage;
  json["with_cloud"] = request.with_cloud;
  json["with_map"] = request.with_map;
  json["with_loops"] = request.with_loops;
  json["with_pictures"] = request.with_pictures;
  json["topics"] = topics_json(request.settings.log.topics);
  json["config_yaml"] = config_text(option_table(settings));
  if (kept.prepared) json["prepared"] = prepared_json(*kept.prepared);
  write_json(file, json);
}

KeptRequest read_continue_file(const std::string& file, const std::string& folder) {
  const std::string advice = kMapAgain + folder;
  const auto json = std::make_shared<const Json>(read_json(file, kMostContinueBytes, advice));
  const ReportReader reader(file, folder, json);
  if (reader.whole("format") != kContinueVersion) {
    throw InputError({file, 0}, fmt::format("has format {}, and this program reads {}{}", reader.whole("format"),
                                            kContinueVersion, advice));
  }
  // Before the rest: GCC 12 destroys members that were never made where a later one of them cannot be.
  std::vector<std::string> paths = reader.texts("path");
  KeptRequest kept{.request = {.logs = reader.texts("log"),
                               .settings = settings_from(reader, file, advice),
                               .lenient = reader.truth("lenient"),
                               .range = range_from(reader),
                               .linkage = reader.text("linkage"),
                               .with_cloud = reader.truth("with_cloud"),
                               .with_map = reader.truth("with_map"),
                               .with_loops = reader.truth("with_loops"),
                               .with_pictures = reader.truth("with_pictures")},
                   .paths = std::move(paths)};
  if (kept.request.logs.empty() || kept.paths.size() != kept.request.logs.size()) {
    throw InputError({file, 0}, "'log' and 'path' do not name the same logs" + advice);
  }
  if (reader.has("prepared")) kept.prepared = prepared_from(reader.section("prepared"), file);
  return kept;
}

}  // namespace gdtslam
