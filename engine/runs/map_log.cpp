#include "gdtslam/runs/map_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "engine/core/memory/free_memory.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/runs/continuing/continuation.hpp"
#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/continuing/log_copies.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "engine/runs/folder/run_times.hpp"
#include "engine/runs/inputs/files_of_runs.hpp"
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
  folder.without("cloud.png");
}

/// What a run has before its first scan.
struct RunStart {
  ScanStream scans;
  LogCopies& copies;
  RunPreparation prepared;
  std::uint64_t& mapped;  // scans, from then on
};

// `nodding` is null where the laser does not nod.
MapResult map_into(RunFolder& folder, const MapRequest& request, const MapJob& job, const NoddingJob* nodding,
                   Backend& backend, RunStart start, RunTimes& times) {
  std::unique_ptr<CloudOutput> cloud;
  std::string cloud_file;
  if (nodding != nullptr && request.with_cloud) {
    cloud_file = folder.staged("cloud.ply");
    cloud = std::make_unique<CloudOutput>(request.settings.cloud, cloud_file);
  } else {
    folder.without("cloud.ply");
  }
  auto run = std::make_unique<MapRun>(job, backend, std::move(start.scans), nodding, std::move(cloud));
  MapResult result;
  times.add("prepare");
  const auto progress = [&](std::uint64_t scans, double share) {
    start.mapped = scans;
    if (request.progress) request.progress(scans, share);
  };
  result.outcome = run->run(progress, [&request] { return stopped(request); });
  times.skip();  // its stages are in the outcome
  if (request.with_copies) {
    start.copies.finish(!result.outcome.interrupted);
  } else {
    LogCopies::leave_out(folder);
  }
  result.outcome.findings = job.findings;
  if (nodding == nullptr) look_afterwards(request, job, start.copies.first_log(), result.outcome);
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
  } else {
    folder.without("cloud.png");
    folder.without("linkage.yaml");
  }
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

// What the first log tells before it is mapped; a run that is gone on with knows it.
RunPreparation prepare(MapRequest& request, MapJob& job, const LogCopies& copies, NodKind kind) {
  RunPreparation prepared{.nods = kind, .linkage = {}, .linkage_yaml = {}, .delay = {}, .findings = job.findings};
  if (kind == NodKind::kNone) {
    look_at_motion(request, job, copies.first_log(), prepared);
  } else {
    const NoddingJob nodding = nodding_job(request, kind);
    prepared.linkage = nodding.linkage;
    prepared.linkage_yaml = linkage_text(nodding.model);
  }
  return prepared;
}

NoddingJob prepared_nodding_job(const MapRequest& request, const RunPreparation& prepared) {
  return {.kind = prepared.nods,
          .model = read_linkage_text(prepared.linkage_yaml, kContinueFile).model,
          .linkage = prepared.linkage,
          .nodding = request.settings.nodding,
          .limits = request.settings.nod_limits,
          .check = {}};
}

MapResult map_prepared(RunFolder& folder, const MapRequest& request, const MapJob& job, Backend& backend,
                       RunStart start, RunTimes& times) {
  MapJob whole = job;
  whole.findings = start.prepared.findings;
  if (start.prepared.nods == NodKind::kNone) {
    whole.odometry_delay = start.prepared.delay;
    if (whole.odometry_delay) start.scans.set_odometry_delay(whole.odometry_delay->delay_s);
    return map_into(folder, request, whole, nullptr, backend, std::move(start), times);
  }
  const NoddingJob nodding = prepared_nodding_job(request, start.prepared);
  return map_into(folder, request, whole, &nodding, backend, std::move(start), times);
}

ForeignFiles foreign_files_of(const MapRequest& request) {
  return request.replace_foreign_files ? ForeignFiles::kReplaced : ForeignFiles::kKept;
}

std::unique_ptr<RunFolder> new_folder(const MapRequest& request) {
  auto folder = std::make_unique<RunFolder>(request.folder, foreign_files_of(request));
  if (request.folder_taken) request.folder_taken(folder->staging());
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

// In the handler of what ended a run with a log that cannot be read again: logs up to that one stay, and are told of.
[[noreturn]] void keep_what_came(RunFolder& folder, LogCopies& copies, const MapRequest& request, KeptRequest kept,
                                 std::size_t logs) {
  copies.keep(folder, logs);
  if (logs < kept.paths.size()) {
    kept.request.logs.resize(logs);
    kept.paths.resize(logs);
    write_continue_file(folder.staged_path(kContinueFile), kept);
  }
  const std::string told =
      fmt::format("; what came by then is kept: gdtslam map --continue {} makes a map of it", folder.path());
  try {
    throw;
  } catch (const InputError& error) {
    if (error.has_position()) throw Error(error.code(), error.what() + told);
    throw InputError(FilePosition{log_name(request.logs.front()), 0}, error.what() + told);
  } catch (const Error& error) {
    throw Error(error.code(), error.what() + told);
  } catch (const std::bad_alloc&) {
    throw Error(ExitCode::kFailed, "out of memory" + told);
  }
}

// `continued` is null for a new run. Whoever maps live may wait long for the first scan, and a folder that cannot be
// had shows before.
MapResult map_opened(MapRequest request, MapJob job, const BackendOfRun& backend_of, const Continuation* continued) {
  RunTimes times;
  KeptRequest kept = continued != nullptr ? continued->kept : kept_request_of(request);
  LogCopies copies(job.logs, kept.paths, job.read, request.live_log);
  std::unique_ptr<RunFolder> folder;
  if (continued != nullptr) {
    folder = folder_to_continue(*continued, request.folder, foreign_files_of(request));
    copies.write_into(*folder);
  } else if (request.scan_mapped) {
    folder = new_folder(request);
  }
  ScanStream::OpenLog open;
  if (request.with_copies) {
    open = [&copies](std::size_t log) { return copies.open(log); };
  } else if (request.live_log) {
    open = [&request, &job](std::size_t) { return request.live_log(job.read); };
  }
  ScanStream scans(job.logs, job.read, job.range, open);
  const NodKind kind = kept.prepared ? kept.prepared->nods : nod_kind_of_start(request, scans);
  Backend& backend =
      backend_of(kind != NodKind::kNone || matcher_info(job.mapper.match.matcher).place == MatcherPlace::kDevice);
  if (!folder) folder = new_folder(request);
  if (continued == nullptr) {
    folder->remove_leftovers();
    if (request.with_copies) copies.write_into(*folder);
  }
  if (!kept.prepared) {
    if (request.with_copies) write_continue_file(folder->staged_path(kContinueFile), kept);
    kept.prepared = prepare(request, job, copies, kind);
    kept.request.settings.log = request.settings.log;
    scans.set_beam_times(job.read);
    if (request.with_copies && !stopped(request)) write_continue_file(folder->staged_path(kContinueFile), kept);
  }
  std::uint64_t mapped = 0;
  try {
    return map_prepared(*folder, request, job, backend, {std::move(scans), copies, *kept.prepared, mapped}, times);
  } catch (...) {
    const bool is_finished = continued != nullptr && continued->leftover.empty();
    const std::size_t logs = copies.logs_to_keep(is_finished ? continued->copies.size() : 0);
    if (mapped == 0 || !request.with_copies || logs == 0 || is_interruption()) throw;
    keep_what_came(*folder, copies, request, kept, logs);
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

void require_own_names(const MapRequest& request) {
  if (request.replace_foreign_files) return;
  std::vector<std::string> copies;
  for (std::size_t log = 0; request.with_copies && log < request.logs.size(); ++log)
    copies.push_back(log_copy_name(log));
  require_no_foreign_files(request.folder, copies);
}

MapResult map_new(MapRequest request, const BackendOfRun& backend) {
  std::vector<LogFinding> findings = look_at_ranges(request);
  MapJob job = job_of(request);
  job.findings = std::move(findings);
  return map_opened(std::move(request), std::move(job), backend, nullptr);
}

}  // namespace

MapResult map_logs(const MapRequest& request, const BackendOfRun& backend) {
  if (request.continued != request.folder) require_logs_elsewhere(request.logs, request.folder);
  require_own_names(request);
  try {
    if (request.continued.empty()) return map_new(request, backend);
    const Continuation continued = continuation_of(request.continued, request.logs, request.stop);
    if (!continued.remark.empty() && request.warn) request.warn(continued.remark);
    const MapRequest whole = restored(request, continued.kept);
    require_own_names(whole);  // those of the copies of all its logs
    return map_opened(whole, job_of(whole), backend, &continued);
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
