#include "continue_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/core/signals_blocked.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostWaitingBytes = std::size_t{1} << 20U;
constexpr std::chrono::seconds kLongestWait{1};

}  // namespace

bool is_stream(const std::string& log) {
  std::error_code ignored;  // opening reports a missing file
  const std::filesystem::file_status status = std::filesystem::status(log, ignored);
  return log == "-" || std::filesystem::is_other(status) || std::filesystem::is_fifo(status) ||
         std::filesystem::is_socket(status) || std::filesystem::is_character_file(status);
}

StreamFile::StreamFile(std::string file) : path_(std::move(file)), file_(path_, std::ios::binary) {
  if (!file_) throw FileError(path_, "cannot be created: " + errno_text(errno));
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { work(); });
}

StreamFile::~StreamFile() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_one();
  thread_.join();
}

void StreamFile::add(const LogRecord& record) {
  std::string line = json_line(record);
  has_scan_ = has_scan_ || std::holds_alternative<ScanRecord>(record);
  const std::lock_guard lock(mutex_);
  lines_ += line;
  if (lines_.size() >= kMostWaitingBytes || !file_) write();
}

// The next add() or sync() reports a failed write.
void StreamFile::work() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kLongestWait, [this] { return is_over_; })) {
    without_throwing([this] { write(); });
  }
}

void StreamFile::write() {
  if (!file_) throw FileError(path_, "cannot be written: " + errno_text(EIO));
  if (lines_.empty()) return;
  file_ << packed_chunk(lines_, ChunkPacking::kZstd) << std::flush;
  const int why = errno;
  if (!file_) throw FileError(path_, "cannot be written: " + errno_text(why));
  lines_.clear();
}

void StreamFile::sync() {
  const std::lock_guard lock(mutex_);
  write();
  const int descriptor = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int why = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!is_synced) throw FileError(path_, "cannot be written: " + errno_text(why));
}

std::optional<LogRecord> KeptStream::next() {
  std::optional<LogRecord> record = log_->next();
  if (record) file_->add(*record);
  return record;
}

namespace {

using Json = nlohmann::ordered_json;

namespace fs = std::filesystem;

constexpr int kContinueVersion = 2;
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

ScanRange range_from(const ReportReader& file) {
  ScanRange range{.skip = file.whole("skip")};
  if (file.has("first")) range.count = file.whole("first");
  return range;
}

Settings settings_from(const ReportReader& file, const std::string& name) {
  Settings settings;
  try {
    read_config_text(file.text("config_yaml"), name + " (its 'config_yaml')", option_table(settings));
    require_valid(settings);
  } catch (const ConfigError& error) {
    file.fail("config_yaml", error.what());
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

std::string full_path(const std::string& log) {
  std::error_code failed;
  const fs::path path = fs::absolute(log, failed);
  return failed ? log : path.string();
}

bool is_of_run(const KeptLog& log) { return fs::path(log.path).is_relative(); }

// Refuses a linkage file with other content than the run's.
void require_same_linkage(const KeptRequest& kept, const std::string& folder) {
  const std::string& linkage = kept.request.linkage;
  std::error_code ignored;
  if (linkage.empty() || !fs::exists(linkage, ignored)) return;  // a preset, or its reader reports the fault
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
    const auto is_same = [&sha256](const KeptLog& kept) { return !sha256.empty() && kept.sha256 == sha256; };
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
  json["logs"] = Json::array();
  for (const KeptLog& log : kept.logs) {
    json["logs"].push_back({{"name", log.name}, {"path", log.path}, {"sha256", log.sha256}});
  }
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
  const ReportReader reader(file, advice, read_json(file, kMostContinueBytes, advice));
  if (reader.whole("format") != kContinueVersion) {
    reader.fail(fmt::format("has format {}, and this program reads {}", reader.whole("format"), kContinueVersion));
  }
  KeptRequest kept;
  MapRequest& request = kept.request;
  request.settings = settings_from(reader, file);
  request.lenient = reader.truth("lenient");
  request.range = range_from(reader);
  request.linkage = reader.text("linkage");
  request.with_cloud = reader.truth("with_cloud");
  request.with_map = reader.truth("with_map");
  request.with_loops = reader.truth("with_loops");
  request.with_pictures = reader.truth("with_pictures");
  kept.linkage_sha256 = reader.text("linkage_sha256");
  for (const ReportReader& log : reader.entries("logs")) {
    kept.logs.push_back({log.text("name"), log.text("path"), log.text("sha256")});
  }
  if (kept.logs.empty()) reader.fail("logs", "is empty");
  return kept;
}

// If a log is removed or changed while it is mapped, the run cannot be continued.
KeptLog kept_log(const std::string& log, const std::optional<FileState>& before, const std::string& kept_file) {
  if (!kept_file.empty()) {
    return {log, fs::path(kept_file).filename().string(), sha256_of_file(kept_file).sha256};
  }
  KeptLog kept{log, full_path(log), {}};
  if (is_stream(log) || state_of_file(log) != before) return kept;
  try {
    kept.sha256 = sha256_of_log(log);
  } catch (const FileError&) {
    return kept;
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
  return !is_of_run(log) && full_path(log.name) == path ? log.name : path;
}

MapRequest continued_request(const MapRequest& request) {
  const std::string file = (fs::path(request.continued) / kContinueFile).string();
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw InputError({request.continued, 0}, "has no continue.json, as 'gdtslam map' leaves one; map its logs again");
  }
  const KeptRequest kept = read_continue_file(file, request.continued);
  require_same_linkage(kept, request.continued);
  MapRequest whole = request;
  whole.settings = kept.request.settings;
  whole.lenient = kept.request.lenient;
  whole.range = kept.request.range;
  whole.linkage = kept.request.linkage;
  whole.with_cloud = kept.request.with_cloud;
  whole.with_map = kept.request.with_map;
  whole.with_loops = kept.request.with_loops;
  whole.with_pictures = kept.request.with_pictures;
  whole.logs.clear();
  for (const KeptLog& log : kept.logs) whole.logs.push_back(log_of_run(log, request.continued));
  // Topics and mounts were applied when the records were kept as lines.
  if (std::all_of(kept.logs.begin(), kept.logs.end(), is_of_run)) whole.settings.log.topics = {};
  add_logs(request.logs, kept.logs, whole);
  return whole;
}

}  // namespace gdtslam
