#include "run_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/continuing/log_copies.hpp"
#include "engine/runs/motion/scan_speed.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::string copy_in(const std::string& folder, std::size_t log) {
  return (std::filesystem::path(folder) / log_copy_name(log)).string();
}

std::string continue_file_in(const std::string& folder) {
  return (std::filesystem::path(folder) / kContinueFile).string();
}

// Opening says what is wrong with one of an older run.
std::string copy_of(const RunFiles& run, std::size_t log) {
  const std::string name = log_copy_name(log);
  return run.is_told() ? run.checked(name) : run.path(name);
}

std::uint64_t from_copies(const RunScans& run, const std::function<void(LaserScan&, const Pose2&)>& take) {
  const std::string& folder = run.files.folder();
  const KeptRequest kept =
      run.files.read(kContinueFile, [&](const std::string& file) { return read_continue_file(file, folder); });
  const MapRequest& request = kept.request;
  const ReadOptions options = read_options_of(request.settings.log, request.lenient);
  ScanStream scans(request.logs, options, request.range,
                   [&](std::size_t log) { return open_log(copy_of(run.files, log), options); });
  if (kept.prepared && kept.prepared->delay) scans.set_odometry_delay(kept.prepared->delay->delay_s);
  MapSpeed speed;
  std::uint64_t cast = 0;
  for (std::size_t i = 0; i < run.trajectory.size(); ++i) {
    std::optional<ScanRecord> record = scans.next();
    if (!record) {
      throw InputError({folder, 0},
                       fmt::format("has copies of its logs with {} scans, and {} poses: not of one run; leave "
                                   "continue.json out and its keyframes are taken",
                                   i, run.trajectory.size()));
    }
    const Pose2& T = run.trajectory[i].T_map_base;
    speed.complete(*record);
    speed.take(*record, T);
    if (std::binary_search(run.refused.begin(), run.refused.end(), i)) continue;
    take(record->scan, T);
    ++cast;
  }
  return cast;
}

}  // namespace

bool has_log_copies(const std::string& folder) {
  std::error_code ignored;
  return std::filesystem::exists(continue_file_in(folder), ignored) &&
         std::filesystem::exists(copy_in(folder, 0), ignored);
}

std::uint64_t for_each_cast_scan(const RunScans& run,
                                 const std::function<void(LaserScan& scan, const Pose2& T)>& take) {
  if (has_log_copies(run.files.folder())) {
    return run.files.unless_changed([&] { return from_copies(run, take); });
  }
  for (const RunKeyframe& keyframe : run.keyframes) {
    LaserScan scan = keyframe.laser;
    take(scan, keyframe.T_map_base);
  }
  return run.keyframes.size();
}

}  // namespace gdtslam
