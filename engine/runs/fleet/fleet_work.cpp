#include "fleet_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "engine/core/files/file_state.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/transaction/folder_transaction.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// Results with the same bytes on every machine; report.json has times, and pictures depend on fonts.
constexpr std::array<std::string_view, 9> kHashedFiles{"cloud.ply", "config.yaml", "covariance.csv",
                                                       "gdt.yaml",  "graph.g2o",   "linkage.yaml",
                                                       "map.pgm",   "map.yaml",    "trajectory.tum"};
constexpr std::array kHashedKeys{"map_sha256", "trajectory_sha256", "keyframes_sha256"};

constexpr PictureSize kThumbnailSize{.width = 320, .height = 180};  // below 200 pixels a picture has no text

bool is_fault_of_the_log(ExitCode code) {
  return code == ExitCode::kBadInput || code == ExitCode::kUsage || code == ExitCode::kBadConfig;
}

/// The current files of a log.
struct LogFiles {
  std::vector<std::string> paths;  ///< the file; for a ROS 2 bag the files in its folder, sorted
  std::vector<std::optional<FileState>> states;
};

LogFiles list_files(const std::string& log, const std::string& sidecar) {
  LogFiles files{.paths = {log}, .states = {}};
  std::error_code failed;
  if (fs::is_directory(log, failed)) {
    files.paths.clear();
    for (const fs::path& entry : list_folder(log, failed)) {
      if (state_of_file(entry)) files.paths.push_back(entry.string());
    }
    std::sort(files.paths.begin(), files.paths.end());
  } else if (!state_of_file(log) && lies_there(log)) {
    throw FileError(log, "is not a regular file");  // a device has no end
  }
  for (const std::string& path : files.paths) files.states.push_back(state_of_file(path));
  files.states.push_back(state_of_file(sidecar));
  return files;
}

void hash_log(const LogFiles& files, const std::function<void()>& unless_stopped, FleetRecord& record) {
  Sha256 hash;
  for (const std::string& path : files.paths) {
    const HashedBytes hashed = sha256_of_file(path, unless_stopped);
    record.bytes += hashed.bytes;
    record.log_sha256 = hashed.sha256;
    hash.update(fmt::format("{} {}\n", hashed.sha256, fs::path(path).filename().string()));
  }
  if (files.paths != std::vector{record.log}) record.log_sha256 = hash.hex();
}

bool is_done(const std::optional<FleetRecord>& before, const FleetRecord& now, const std::string& atlas) {
  return before && before->is_mapped() && before->log_sha256 == now.log_sha256 &&
         before->options_sha256 == now.options_sha256 &&
         lies_there(fmt::format("{}/{}/{}", atlas, now.run, kReportFile));
}

void take_results(const std::string& report_text, FleetRecord& record) {
  const auto report = nlohmann::json::parse(report_text);
  report.at("scans").get_to(record.scans);
  report.at("doubtful").get_to(record.doubtful);
  report.at("keyframes").get_to(record.keyframes);
  report.at("path_m").get_to(record.path_m);
  report.at("log_duration_s").get_to(record.log_duration_s);
  report.at("cpu_s").get_to(record.cpu_s);
  report.at("wall_s").get_to(record.wall_s);
  const auto& map = report.at("gdt");
  record.width_m = map.at("resolution_m").get<double>() * map.at("width").get<double>();
  record.height_m = map.at("resolution_m").get<double>() * map.at("height").get<double>();
  const auto& device = report.at("device");
  record.device = device.at("name").get<std::string>() + ", " + device.at("driver").get<std::string>();
  Sha256 hash;
  for (const char* key : kHashedKeys) {
    if (report.contains(key)) hash.update(fmt::format("{} {}\n", key, report.at(key).get<std::string>()));
  }
  for (const auto& file : report.at("files")) {  // rows of name, bytes and SHA-256, sorted by name
    const auto name = file.at(0).get<std::string>();
    if (std::find(kHashedFiles.begin(), kHashedFiles.end(), name) != kHashedFiles.end())
      hash.update(fmt::format("{} {}\n", name, file.at(2).get<std::string>()));
  }
  record.result_sha256 = hash.hex();
}

// Removes the name of the log, which has its own column.
std::string clean_reason(std::string message, const std::string& log) {
  if (!message.starts_with(log + ":")) return message;
  message.erase(0, log.size() + 1);
  return message.starts_with(' ') ? message.substr(1) : "line " + message;
}

}  // namespace

MappedFleetLog map_fleet_log(const FleetWork& work, const std::string& log) {
  if (!lies_there(fmt::format("{}/{}", work.atlas, kOptionsFile))) throw FileError(work.atlas, "is gone");
  const std::string folder = record_folder(work.atlas, log);
  make_folder(folder);
  const FolderLock lock(folder);
  FleetRecord record{.log = log, .run = "runs/" + name_in_atlas(log), .host = work.host};
  MapRequest request = work.request;
  request.logs = {log};
  request.folder = work.atlas + "/" + record.run;
  // Nobody needs a part of a log, so a stopped run leaves nothing.
  request.stop = [&work] {
    if (work.request.stop && work.request.stop()) throw Error(ExitCode::kInterrupted, "interrupted");
    return false;
  };
  try {
    const std::string sidecar = request.linkage.empty() ? sidecar_path(log, kLinkageSidecar) : std::string();
    const LogFiles files = list_files(log, sidecar);
    Sha256 options;
    options.update(work.options);
    if (files.states.back()) options.update(sha256_of_file(sidecar).sha256);
    record.options_sha256 = options.hex();
    hash_log(
        files, [&request] { (void)request.stop(); }, record);
    if (const std::optional<FleetRecord> before = read_record(work.atlas, log); is_done(before, record, work.atlas))
      return {.record = *before, .was_done = true};
    const MapResult result = work.map(request);
    if (const LogFiles now = list_files(log, sidecar); now.paths != files.paths || now.states != files.states)
      throw FileError(log, "was changed while it was mapped; run the command again");
    write_thumbnail(folder, result.outcome);
    take_results(result.report, record);
    record.outcome = "mapped";
  } catch (const Error& error) {
    if (error.code() == ExitCode::kInterrupted) throw;
    record.outcome = is_fault_of_the_log(error.code()) ? "refused" : "failed";
    record.exit_code = static_cast<int>(error.code());
    record.reason = clean_reason(error.what(), log);
  }
  write_record(work.atlas, record);
  return {.record = record};
}

void write_thumbnail(const std::string& folder, const MapOutcome& outcome) {
  if (outcome.occupancy.cells.size() == 0) return;
  std::string bytes;
  try {
    MapLook look;
    look.with_keyframes = false;
    const RgbaImage image =
        rasterise(map_picture(outcome.occupancy, {outcome.trajectory, {}, {}, {}}, look, kThumbnailSize), 2.0);
    bytes = encode_png(image.width, image.height, image.pixels);
  } catch (const Error&) {  // the page has no thumbnail then
    return;
  }
  write_file_atomically(folder + "/" + kThumbnailName, bytes);
}

}  // namespace gdtslam
