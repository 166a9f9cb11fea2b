#include "source_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/motion/scan_speed.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

std::string path_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

RunKeyframes require_keyframes(const RunReader& reader) {
  if (reader.summary().nods) {
    throw InputError({reader.folder(), 0},
                     "is a run of a laser that nods, whose scans are not kept; only flat lasers' runs can be edited");
  }
  std::optional<RunKeyframes> kept = reader.keyframes();
  if (!kept || kept->keyframes.empty()) {
    throw InputError({reader.folder(), 0},
                     "has no keyframes.bin.gz, which older versions did not write: map its log again");
  }
  return *std::move(kept);
}

std::vector<std::size_t> refused_scans(const RunReader& reader) {
  const ReportReader report = reader.files().report();
  std::vector<std::size_t> refused;
  for (const ReportReader& scan : report.entries("doubtful_scans")) {
    if (!scan.truth("accepted")) refused.push_back(scan.index("index", reader.summary().scans));
  }
  std::sort(refused.begin(), refused.end());
  return refused;
}

// The parts of an outcome for pictures and files of the run.
MapOutcome read_outcome(const RunReader& reader, const RunKeyframes& kept) {
  const RunSummary& summary = reader.summary();
  MapOutcome outcome;
  outcome.trajectory = reader.trajectory();
  for (const RunKeyframe& keyframe : kept.keyframes) {
    outcome.keyframes.push_back(keyframe.scan);
    outcome.trajectory[keyframe.scan].T_map_base = keyframe.T_map_base;
  }
  outcome.drives = summary.drives;
  for (const std::size_t scan : summary.doubtful) {
    DoubtfulScan doubtful;
    doubtful.index = scan;
    outcome.doubtful.push_back(doubtful);
  }
  outcome.statistics.scans = summary.scans;
  outcome.statistics.matched = summary.matched;
  outcome.statistics.doubtful = summary.doubtful.size();
  outcome.statistics.keyframes = summary.keyframe_count;
  outcome.statistics.path_m = summary.path_m;
  if (!summary.has_loops) return outcome;
  ClosedPath closed;
  closed.is_closed = true;
  std::optional<std::vector<PoseCovariance>> covariances = reader.covariances();
  if (!covariances) throw InputError({path_in(reader.folder(), "covariance.csv"), 0}, "is missing in this run");
  closed.covariances = *std::move(covariances);
  closed.keyframes = outcome.keyframes;
  RunDoubts doubts = reader.doubts();
  if (doubts.loops) closed.loops = std::move(doubts.loops->loops);
  outcome.closed = std::move(closed);
  return outcome;
}

// Counted from the sessions' files, because a run that is itself a site has several drives.
std::vector<std::size_t> scans_of_sessions(const RunReader& reader) {
  std::vector<std::size_t> scans;
  std::uint64_t sum = 0;
  for (std::size_t k = 0; reader.files().has(session_file_name(k)); ++k) {
    scans.push_back(reader.files().read(session_file_name(k), [](const std::string& f) { return read_tum(f); }).size());
    sum += scans.back();
  }
  if (!scans.empty() && sum != reader.summary().scans) {
    throw InputError({path_in(reader.folder(), session_file_name(0)), 0},
                     fmt::format("has with its like {} poses, but {} tells of {} scans: not of one run", sum,
                                 kReportFile, reader.summary().scans));
  }
  return scans;
}

void turn(const SinCos<double>& by, PoseCovariance& c) {
  const auto [s, k] = by;
  const PoseCovariance was = c;
  c.xx = k * k * was.xx - 2.0 * k * s * was.xy + s * s * was.yy;
  c.xy = k * s * (was.xx - was.yy) + (k * k - s * s) * was.xy;
  c.yy = s * s * was.xx + 2.0 * k * s * was.xy + k * k * was.yy;
  c.xt = k * was.xt - s * was.yt;
  c.yt = s * was.xt + k * was.yt;
}

/// The logs of a run and its options for reading them.
struct RunLogs {
  std::vector<std::string> paths;
  ReadOptions options;
  ScanRange range;
};

// None if a log is gone or was changed, or if the run is of an older version.
std::optional<RunLogs> logs_of_run(const SourceRun& run) {
  const RunFiles& files = run.reader.files();
  if (!files.has(kContinueFile)) return std::nullopt;
  const std::string file = files.checked(kContinueFile);
  try {
    const KeptRequest kept = read_continue_file(file, files.folder());
    RunLogs logs{
        .paths = {}, .options = read_options_of(run.settings.log, kept.request.lenient), .range = kept.request.range};
    logs.options.topics = kept.request.settings.log.topics;
    for (const KeptLog& log : kept.logs) logs.paths.push_back(log_of_run(log, files.folder()));
    return logs;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

using TakeScan = std::function<void(LaserScan& scan, const Pose2& T, double share)>;

void take_from_logs(const SourceRun& run, const RunLogs& logs, const TakeScan& take) {
  const Trajectory& trajectory = run.outcome.trajectory;
  ScanStream scans(logs.paths, logs.options, logs.range);
  const ReportReader report = run.reader.files().report();
  const double delay_s = report.has("odometry_delay") ? report.section("odometry_delay").number("delay_s") : 0.0;
  if (delay_s != 0.0) scans.set_odometry_delay(delay_s);
  MapSpeed speed;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    std::optional<ScanRecord> record = scans.next();
    if (!record) {
      throw InputError({run.reader.folder(), 0},
                       fmt::format("has {} poses, and its logs have {} scans: not of one run", trajectory.size(), i));
    }
    speed.complete(*record);
    speed.take(*record, trajectory[i].T_map_base);
    if (std::binary_search(run.refused.begin(), run.refused.end(), i)) continue;
    take(record->scan, trajectory[i].T_map_base, static_cast<double>(i) / static_cast<double>(trajectory.size()));
  }
}

}  // namespace

SourceRun read_source_run(const std::string& folder) {
  RunReader reader(folder);
  RunKeyframes kept = require_keyframes(reader);
  MapOutcome outcome = read_outcome(reader, kept);
  SourceRun run{.reader = reader,
                .report = read_json(path_in(folder, kReportFile), kMostReportBytes),
                .settings = reader.settings(),
                .kept = std::move(kept),
                .refused = refused_scans(reader),
                .outcome = std::move(outcome),
                .graph = {},
                .sessions = scans_of_sessions(reader),
                .earlier = {}};
  if (run.outcome.closed) run.graph = reader.graph();
  if (reader.files().has(kEditsFile)) run.earlier = reader.files().read(kEditsFile, read_edits);
  return run;
}

void move_to_frame(const Pose2& T_edited_run, SourceRun& run) {
  for (StampedPose& pose : run.outcome.trajectory) pose.T_map_base = T_edited_run * pose.T_map_base;
  for (GraphPlace& place : run.graph.places) place.T_map_base = T_edited_run * place.T_map_base;
  const auto by = sin_cos(T_edited_run.theta_rad);
  if (run.outcome.closed) {
    for (PoseCovariance& covariance : run.outcome.closed->covariances) turn(by, covariance);
  }
  for (RunKeyframe& keyframe : run.kept.keyframes) {
    keyframe.T_map_base = run.outcome.trajectory[keyframe.scan].T_map_base;
    if (keyframe.covariance) turn(by, *keyframe.covariance);
  }
}

bool for_each_cast_scan(const SourceRun& run, const TakeScan& take) {
  if (const std::optional<RunLogs> logs = logs_of_run(run)) {
    run.reader.files().unless_changed([&] {
      take_from_logs(run, *logs, take);
      return true;
    });
    return true;
  }
  const std::vector<RunKeyframe>& keyframes = run.kept.keyframes;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    LaserScan scan = keyframes[k].laser;
    take(scan, keyframes[k].T_map_base, static_cast<double>(k) / static_cast<double>(keyframes.size()));
  }
  return false;
}

}  // namespace gdtslam
