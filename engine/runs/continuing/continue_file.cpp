#include "continue_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "kept_stream.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kContinueVersion = 2;
namespace fs = std::filesystem;

constexpr std::size_t kMostContinueBytes = std::size_t{16} << 20U;
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

Json logs_json(const std::vector<KeptLog>& logs) {
  Json rows = Json::array();
  for (const KeptLog& log : logs) rows.push_back({{"name", log.name}, {"path", log.path}, {"sha256", log.sha256}});
  return rows;
}

std::vector<KeptLog> logs_from(const ReportReader& file) {
  std::vector<KeptLog> logs;
  for (const ReportReader& log : file.entries("logs")) {
    logs.push_back({log.text("name"), log.text("path"), log.text("sha256")});
  }
  return logs;
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

std::string sha256_of_log(const std::string& log) {
  std::error_code ignored;
  if (!fs::is_directory(log, ignored)) return sha256_of_file(log).sha256;
  std::error_code failed;
  std::vector<fs::path> files = list_folder(log, failed);
  if (failed) throw FileError(log, "cannot be listed: " + failed.message());
  std::sort(files.begin(), files.end());
  Sha256 hash;
  for (const fs::path& file : files) {
    if (fs::is_regular_file(file, ignored)) hash.update(sha256_of_file(file.string()).sha256);
  }
  return hash.hex();
}

// A log that goes away while it is mapped leaves a run that cannot be continued.
std::string sha256_unless_gone(const std::string& log) {
  try {
    return sha256_of_log(log);
  } catch (const FileError&) {
    return {};
  }
}

std::string absolute_path_of(const std::string& log) {
  std::error_code failed;
  const fs::path path = fs::absolute(log, failed);
  return failed ? log : path.string();
}

bool is_of_run(const KeptLog& log) { return fs::path(log.path).is_relative(); }

// Topics and mounts were applied when the records were kept as lines.
void forget_topics(const std::vector<KeptLog>& logs, LogConfig& log) {
  if (!std::all_of(logs.begin(), logs.end(), is_of_run)) return;
  log.topics = {};
}

// A file of another content is not read, whoever named it.
void require_same_linkage(const KeptRequest& kept, const std::string& folder) {
  const std::string& linkage = kept.request.linkage;
  std::error_code ignored;
  if (linkage.empty() || !fs::exists(linkage, ignored)) return;  // a preset, or its reader says what is wrong
  if (fs::is_regular_file(linkage, ignored) && sha256_of_file(linkage).sha256 == kept.linkage_sha256) return;
  throw InputError({linkage, 0}, fmt::format("has another SHA-256 than the linkage that the run in '{}' read", folder));
}

void add_logs(const std::vector<std::string>& more, const std::vector<KeptLog>& before, MapRequest& whole) {
  if (more.empty()) return;
  if (whole.range.count != ScanRange{}.count) {
    throw UsageError(
        fmt::format("--continue: the run in '{}' has its first {} scans only (--first), and a further log "
                    "would add nothing: map its logs again without --first",
                    whole.continued, whole.range.count));
  }
  for (const std::string& log : more) {
    const std::string sha256 = is_stream(log) ? std::string() : sha256_of_log(log);
    const auto is_same = [&sha256](const KeptLog& kept) { return kept.sha256 == sha256; };
    if (std::any_of(before.begin(), before.end(), is_same)) {
      throw UsageError(fmt::format("--continue: the run in '{}' has '{}' already", whole.continued, log));
    }
    whole.logs.push_back(log);
  }
}

}  // namespace

void write_continue_file(const std::string& file, const KeptRequest& kept) {
  const MapRequest& request = kept.request;
  Settings settings = request.settings;
  Json json = Json::object();
  json["format"] = kContinueVersion;
  json["version"] = GDTSLAM_VERSION;
  json["logs"] = logs_json(kept.logs);
  json["lenient"] = request.lenient;
  json["skip"] = request.range.skip;
  if (request.range.count != ScanRange{}.count) json["first"] = request.range.count;
  json["linkage"] = request.linkage;
  json["linkage_sha256"] = fs::is_regular_file(request.linkage) ? sha256_of_file(request.linkage).sha256 : "";
  json["with_cloud"] = request.with_cloud;
  json["with_map"] = request.with_map;
  json["with_loops"] = request.with_loops;
  json["with_pictures"] = request.with_pictures;
  json["topics"] = topics_json(request.settings.log.topics);
  json["config_yaml"] = config_text(option_table(settings));
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
  std::vector<KeptLog> logs = logs_from(reader);
  KeptRequest kept{.request = {.settings = settings_from(reader, file, advice),
                               .lenient = reader.truth("lenient"),
                               .range = range_from(reader),
                               .linkage = reader.text("linkage"),
                               .with_cloud = reader.truth("with_cloud"),
                               .with_map = reader.truth("with_map"),
                               .with_loops = reader.truth("with_loops"),
                               .with_pictures = reader.truth("with_pictures")},
                   .logs = std::move(logs),
                   .linkage_sha256 = reader.text("linkage_sha256")};
  if (kept.logs.empty()) throw InputError({file, 0}, "'logs' is empty" + advice);
  return kept;
}

std::vector<KeptLog> kept_logs(const std::vector<std::string>& logs, const std::vector<std::string>& streams) {
  std::vector<KeptLog> kept;
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const bool is_own = !streams[k].empty();
    const std::string path = is_own ? streams[k] : absolute_path_of(logs[k]);
    kept.push_back({logs[k], is_own ? fs::path(path).filename().string() : path, sha256_unless_gone(path)});
  }
  return kept;
}

std::string log_of_run(const KeptLog& log, const std::string& folder) {
  std::string path = is_of_run(log) ? (fs::path(folder) / log.path).string() : log.path;
  if (is_of_run(log) && !is_kept_log(log.path)) {
    throw InputError({folder, 0}, fmt::format("'{}' in continue.json lies outside of the run", log.path));
  }
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored)) {
    throw InputError({path, 0}, fmt::format("is the log of the run in '{}', and is not there; put it back", folder));
  }
  if (sha256_of_log(path) != log.sha256) {
    throw InputError({path, 0}, fmt::format("has another SHA-256 than the log that the run in '{}' read; give that "
                                            "log its place again, or map the logs that there are",
                                            folder));
  }
  return !is_of_run(log) && absolute_path_of(log.name) == path ? log.name : path;
}

MapRequest continued_request(const MapRequest& request) {
  const std::string file = (fs::path(request.continued) / kContinueFile).string();
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw InputError({request.continued, 0}, "has no continue.json, as 'gdtslam map' leaves one; map its logs again");
  }
  const KeptRequest kept = read_continue_file(file, request.continued);
  MapRequest whole = request;
  const MapRequest& was = kept.request;
  whole.settings = was.settings;
  whole.lenient = was.lenient;
  whole.range = was.range;
  whole.linkage = was.linkage;
  whole.with_cloud = was.with_cloud;
  whole.with_map = was.with_map;
  whole.with_loops = was.with_loops;
  whole.with_pictures = was.with_pictures;
  whole.logs.clear();
  require_same_linkage(kept, request.continued);
  for (const KeptLog& log : kept.logs) whole.logs.push_back(log_of_run(log, request.continued));
  forget_topics(kept.logs, whole.settings.log);
  add_logs(request.logs, kept.logs, whole);
  return whole;
}

}  // namespace gdtslam
