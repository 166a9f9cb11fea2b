#include "gdtslam/runs/map_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "engine/core/memory/free_memory.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/continuing/kept_stream.hpp"
#include "engine/runs/folder/files_of_runs.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "engine/runs/folder/run_times.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "engine/runs/mapping/map_run.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "log_look.hpp"

namespace gdtslam {
namespace {

bool stopped(const MapRequest& request) { return request.stop && request.stop(); }

// The cloud as a picture beside it. Where nothing can draw, the run is as good without.
void add_cloud_picture(const MapRequest& request, const NoddingJob& nodding, const std::string& cloud_file,
                       MapOutcome& outcome, RunFolder& folder) {
  if (request.draw_cloud && request.with_cloud && request.with_pictures && !outcome.interrupted) {
    try {
      if (request.finishing) request.finishing("cloud.png");
      const std::string png = request.draw_cloud(cloud_file, request.logs.front(), outcome.trajectory,
                                                 nodding.kind == NodKind::kEncoder ? &nodding.model : nullptr);
      write_file_atomically(folder.staged("cloud.png"), png);
      return;
    } catch (const Error& error) {
      if (error.code() == ExitCode::kInputOutput) throw;
      outcome.warnings.push_back({"no picture of the cloud", 1, error.what()});
    }
  }
}

/// For each log the file that keeps it; null where it can be read again.
using StreamFiles = std::vector<std::shared_ptr<StreamFile>>;

bool has_scan(const StreamFiles& streams) {
  return std::any_of(streams.begin(), streams.end(), [](const auto& stream) { return stream && stream->has_scan(); });
}

void flush(const StreamFiles& streams) {
  for (const auto& stream : streams) {
    if (stream) stream->sync();
  }
}

/// What a run has before its first scan.
struct RunStart {
  ScanStream scans;
  const StreamFiles& streams;
  const KeptRequest& asked;
};

// continue.json, and the logs that nobody can read again.
void write_inputs(RunFolder& folder, const MapRequest& request, const KeptRequest& asked, const StreamFiles& streams) {
  if (!request.with_continue_file) return;
  std::vector<std::string> names;
  for (std::size_t log = 0; log < streams.size(); ++log) {
    const bool is_of_run = !request.continued.empty() && lies_in(request.continued, request.logs[log]);
    names.push_back(streams[log] || is_of_run ? folder.staged(kept_log_name(log)) : std::string());
    if (is_of_run) copy_file_atomically(request.logs[log], names.back());
  }
  KeptRequest kept = asked;
  kept.logs = kept_logs(request.logs, names);
  write_continue_file(folder.staged(kContinueFile), kept);
}

// `nodding` is null where the laser does not nod.
MapResult map_into(RunFolder& folder, const MapRequest& request, const MapJob& job, const NoddingJob* nodding,
                   Backend& backend, RunStart start, RunTimes& times) {
  std::unique_ptr<CloudOutput> cloud;
  std::string cloud_file;
  if (nodding != nullptr && request.with_cloud) {
    cloud_file = folder.staged("cloud.ply");
    cloud = std::make_unique<CloudOutput>(request.settings.cloud, cloud_file);
  }
  auto run = std::make_unique<MapRun>(job, backend, std::move(start.scans), nodding, std::move(cloud));
  MapResult result;
  times.add("prepare");
  result.outcome = run->run(request.progress, [&request] { return stopped(request); });
  times.skip();  // its stages are in the outcome
  flush(start.streams);
  result.outcome.findings = job.findings;
  if (nodding == nullptr) {
    const auto& stream = start.streams.front();
    look_afterwards(request, job, stream ? stream->path() : request.logs.front(), result.outcome);
  }
  // The memory of what mapped is for the pictures, and the tiles of a large map.
  const auto end_mapping = [&run] {
    run.reset();
    return_free_memory();
  };
  if (result.outcome.is_in_tiles) end_mapping();
  const WrittenField field = result.outcome.is_in_tiles
                                 ? write_run_tiles(folder, job, request.settings, times, result.outcome)
                                 : write_run_field(folder, job, run->field(), times);
  end_mapping();
  if (nodding != nullptr) {
    result.linkage = nodding->linkage;
    add_cloud_picture(request, *nodding, cloud_file, result.outcome, folder);
    times.add("write_cloud_picture");
    write_linkage(folder.staged("linkage.yaml"), nodding->model);
  }
  write_inputs(folder, request, start.asked, start.streams);
  result.report = write_run(folder, {job, nodding, field, backend.device(), request.settings}, times, result.outcome);
  return result;
}

std::string default_linkage_warning(NodKind kind, const NoddingJob& job) {
  if (kind == NodKind::kEncoder) {
    return fmt::format("warning: the laser nods and no --linkage is given: the preset {} is taken", job.linkage);
  }
  return fmt::format(
      "warning: the laser tilts and no --linkage is given: {:g} m over the floor, no lever arm, no time "
      "from beam to beam",
      job.model.mount.height_m);
}

// What was given, else the file that lies beside the log, else the default.
NoddingJob nodding_job(const MapRequest& request, NodKind kind) {
  NoddingJob job;
  job.kind = kind;
  job.nodding = request.settings.nodding;
  job.limits = request.settings.nod_limits;
  job.linkage = request.linkage.empty() ? linkage_sidecar(request.logs.front()) : request.linkage;
  const bool is_default = job.linkage.empty();
  if (is_default) job.linkage = calib::kDefaultLinkage;
  job.model = resolve_linkage(job.linkage);
  if (is_default && kind == NodKind::kTilt) {
    job.model.mirror_rate_hz = 0.0;  // of another laser; nobody knows when its beams fire
  }
  if (is_default && request.warn) request.warn(default_linkage_warning(kind, job));
  return job;
}

std::string no_crank_warning(const std::string& linkage) {
  return fmt::format(
      "warning: {} lies beside the log, which has no ENCODER or TILT message among its first {} records: the laser is "
      "taken to be level; of a recording, --crank NAME says which topic tells how it nods",
      linkage, ScanStream::kMostAhead);
}

// How the laser nods, by the log.
NodKind nod_kind_of_start(const MapRequest& request, ScanStream& scans) {
  if (request.scan_mapped) return NodKind::kNone;
  // Where there is a linkage the mount's messages may be late in the log; else a live log is not kept waiting for them.
  const std::string beside = linkage_sidecar(request.logs.front());
  const bool has_linkage = !request.linkage.empty() || !beside.empty();
  const NodKind kind = scans.nod_kind(has_linkage ? ScanStream::kMostAhead : ScanStream::kScansAhead);
  if (kind == NodKind::kNone && !request.linkage.empty()) {
    scans.expect_readable();
    throw InputError(
        FilePosition{log_name(request.logs.front()), 0},
        fmt::format("has no ENCODER or TILT message among its first {} records, so --linkage has nothing to work on",
                    ScanStream::kMostAhead));
  }
  if (kind == NodKind::kNone && has_linkage && request.warn) request.warn(no_crank_warning(beside));
  return kind;
}

void warn_of_left_logs(const RunFolder& folder, const MapRequest& request, std::size_t known = 0) {
  for (std::size_t k = known; request.warn && k < folder.left_logs().size(); ++k) {
    request.warn(fmt::format("warning: an earlier run left its log, which is kept as {}", folder.left_logs()[k]));
  }
}

std::unique_ptr<RunFolder> new_folder(const MapRequest& request) {
  auto folder = std::make_unique<RunFolder>(
      request.folder, request.replace_foreign_files ? ForeignFiles::kReplaced : ForeignFiles::kKept);
  warn_of_left_logs(*folder, request);
  return folder;
}

bool is_interruption() {
  try {
    throw;
  } catch (const Error& error) {
    return error.code() == ExitCode::kInterrupted;
  } catch (...) {
    return false;
  }
}

// In the handler of what ended a run: streams cannot be had again. Nothing where none was read.
std::string streams_kept(RunFolder& folder, const StreamFiles& streams) {
  std::string told;
  for (std::size_t log = 0; log < streams.size(); ++log) {
    if (!streams[log]) continue;
    try {
      streams[log]->sync();
    } catch (const FileError&) {  // as where a disk is full: there is what was written before
    }
    told +=
        fmt::format("; what was read is kept: gdtslam map {} makes a map of it", folder.keep_log(kept_log_name(log)));
  }
  return told;
}

// In the handler of what ended a run.
[[noreturn]] void throw_with(const std::string& told, const std::string& log) {
  try {
    throw;
  } catch (const InputError& error) {
    if (error.has_position()) throw Error(error.code(), error.what() + told);
    throw InputError(FilePosition{log_name(log), 0}, error.what() + told);
  } catch (const Error& error) {
    throw Error(error.code(), error.what() + told);
  } catch (const std::bad_alloc&) {
    throw Error(ExitCode::kFailed, "out of memory" + told);
  }
}

MapResult map_opened(MapRequest request, MapJob job, const KeptRequest& asked, const BackendOfRun& backend_of) {
  RunTimes times;
  const std::unique_ptr<RunFolder> folder = new_folder(request);
  StreamFiles streams(request.logs.size());
  const auto open = [&](std::size_t log) {
    const std::string& name = request.logs[log];
    const bool is_kept = request.with_continue_file && (request.live_log || is_stream(name));
    std::unique_ptr<LogReader> reader = request.live_log ? request.live_log(job.read) : open_log(name, job.read);
    if (!is_kept) return reader;
    streams[log] = std::make_shared<StreamFile>(folder->staged_path(kept_log_name(log)));
    return std::unique_ptr<LogReader>(std::make_unique<KeptStream>(std::move(reader), streams[log]));
  };
  std::uint64_t mapped = 0;
  request.progress = [&mapped, then = request.progress](std::uint64_t scans, double share) {
    mapped = scans;
    if (then) then(scans, share);
  };
  try {
    ScanStream scans(job.logs, job.read, job.range, open);
    const NodKind kind = nod_kind_of_start(request, scans);
    Backend& backend =
        backend_of(kind != NodKind::kNone || matcher_info(job.mapper.match.matcher).place == MatcherPlace::kDevice);
    std::optional<NoddingJob> nodding;
    RunPreparation prepared{.delay = {}, .findings = job.findings};
    if (kind == NodKind::kNone) {
      look_at_motion(request, job, request.logs.front(), prepared);
    } else {
      nodding = nodding_job(request, kind);
    }
    scans.set_beam_times(job.read);
    if (prepared.delay) scans.set_odometry_delay(prepared.delay->delay_s);
    job.odometry_delay = prepared.delay;
    job.findings = prepared.findings;
    const std::size_t left = folder->left_logs().size();
    MapResult result = map_into(*folder, request, job, nodding ? &*nodding : nullptr, backend,
                                {std::move(scans), streams, asked}, times);
    warn_of_left_logs(*folder, request, left);
    return result;
  } catch (...) {
    if (mapped == 0 && (is_interruption() || !has_scan(streams))) throw;
    const std::string told = streams_kept(*folder, streams);
    if (told.empty()) throw;
    throw_with(told, request.logs.front());
  }
}

MapJob job_of(const MapRequest& request) {
  return {.logs = request.logs,
          .read = read_options_of(request.settings.log, request.lenient),
          .range = request.range,
          .mapper = request.settings.mapper,
          .occupancy = request.settings.occupancy,
          .with_occupancy = request.with_map,
          .with_pictures = request.with_pictures,
          .with_loops = request.with_loops,
          .scan_mapped = request.scan_mapped,
          .stop_ends_log = request.stop_ends_log,
          .closing = request.closing,
          .finishing = request.finishing,
          .on_failure = request.on_failure};
}

void require_not_stopped(const MapRequest& request) {
  if (stopped(request)) throw Error(ExitCode::kInterrupted, "interrupted before the first scan; nothing is written");
}

void require_logs_elsewhere(const MapRequest& request) {
  for (const std::string& log : request.logs) {
    const bool is_folder = place_of_file(log) == place_of_file(request.folder) && std::filesystem::is_directory(log);
    const bool is_of_run = !request.continued.empty() && lies_in(request.continued, log);  // which comes along
    if (log == "-" || is_of_run || !(is_folder || lies_in(request.folder, log))) continue;
    throw UsageError(fmt::format("'{}' lies in the folder that would be replaced; give another folder", one_line(log)));
  }
}

MapResult map_request(MapRequest request, const BackendOfRun& backend) {
  require_logs_elsewhere(request);
  const KeptRequest asked{.request = request, .logs = {}};
  std::vector<LogFinding> findings = look_at_ranges(request);
  MapJob job = job_of(request);
  job.findings = std::move(findings);
  return map_opened(std::move(request), std::move(job), asked, backend);
}

}  // namespace

MapResult map_logs(const MapRequest& request, const BackendOfRun& backend) {
  try {
    return map_request(request.continued.empty() ? request : continued_request(request), backend);
  } catch (const InputError& error) {  // an input that a signal ended before anything came is no bad input
    require_not_stopped(request);
    if (error.has_position()) throw;
    throw InputError(FilePosition{request.logs.empty() ? request.continued : log_name(request.logs.front()), 0},
                     error.what());
  } catch (const MissingTopic&) {
    require_not_stopped(request);
    throw;
  }
}

NodKind nod_kind_of(const std::vector<std::string>& logs, const ReadOptions& options) {
  ScanStream scans(logs, options, {});
  const NodKind kind = scans.nod_kind(ScanStream::kMostAhead);
  scans.expect_readable();
  return kind;
}

}  // namespace gdtslam
