#include "run_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/motion/scan_speed.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

double odometry_delay_s(const ReportReader& report) {
  return report.has("odometry_delay") ? report.section("odometry_delay").number("delay_s") : 0.0;
}

std::uint64_t from_logs(const RunScans& run, const std::function<void(LaserScan&, const Pose2&)>& take) {
  ScanStream scans(run.logs->paths, run.logs->options, run.logs->range);
  if (run.logs->odometry_delay_s != 0.0) scans.set_odometry_delay(run.logs->odometry_delay_s);
  MapSpeed speed;
  std::uint64_t cast = 0;
  for (std::size_t i = 0; i < run.trajectory.size(); ++i) {
    std::optional<ScanRecord> record = scans.next();
    if (!record) {
      throw InputError({run.run.folder(), 0}, fmt::format("has {} poses, and its logs have {} scans: not of one run",
                                                          run.trajectory.size(), i));
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

std::optional<RunLogs> logs_of_run(const RunReader& run, const LogConfig& config) {
  const RunFiles& files = run.files();
  if (!files.has(kContinueFile)) return std::nullopt;
  const std::string file = files.checked(kContinueFile);
  try {
    const KeptRequest kept = read_continue_file(file, files.folder());
    RunLogs logs{.paths = {},
                 .options = read_options_of(config, kept.request.lenient),
                 .range = kept.request.range,
                 .odometry_delay_s = odometry_delay_s(files.report())};
    logs.options.topics = kept.request.settings.log.topics;
    for (const KeptLog& log : kept.logs) logs.paths.push_back(log_of_run(log, files.folder()));
    return logs;
  } catch (const InputError&) {  // of an older version, or its logs are not there any more
    return std::nullopt;
  }
}

std::uint64_t for_each_cast_scan(const RunScans& run,
                                 const std::function<void(LaserScan& scan, const Pose2& T)>& take) {
  if (run.logs) return run.run.files().unless_changed([&] { return from_logs(run, take); });
  for (const RunKeyframe& keyframe : run.keyframes) {
    LaserScan scan = keyframe.laser;
    take(scan, keyframe.T_map_base);
  }
  return run.keyframes.size();
}

}  // namespace gdtslam
