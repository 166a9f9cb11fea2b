#include "gdtslam/runs/map_log.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/files/file_state.hpp"
#include "engine/core/memory/free_memory.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/mapping/match/matchers.hpp"
#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "log_look.hpp"

namespace gdtslam {
namespace {

std::string default_linkage_warning(NodKind kind, const NoddingJob& job) {
  if (kind == NodKind::kEncoder) {
    return fmt::format("warning: the laser nods and no --linkage is given: the preset {} is taken", job.linkage);
  }
  return fmt::format(
      "warning: the laser tilts and no --linkage is given: {:g} m over the floor, no lever arm, no time "
      "from beam to beam",
      job.model.mount.height_m);
}

// Uses the given linkage, else the file beside the log, else the default.
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
    job.model.mirror_rate_hz =
        0.0;  // the preset's rate is that of another laser, and this laser's beam times are unknown
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

// The kind of nodding messages at the start of the log.
NodKind nod_kind_of_start(const MapRequest& request, ScanStream& scans) {
  if (request.scan_mapped) return NodKind::kNone;
  // With a linkage the mount's messages may come late in the log; without one a live log does not wait for them.
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

void require_not_stopped(const MapRequest& request) {
  if (!request.stop || !request.stop()) return;
  throw Error(ExitCode::kInterrupted, "interrupted before the first scan; nothing is written");
}

// True for a log that the run to be continued keeps; it is copied to the new run.
bool is_of_continued_run(const MapRequest& request, const std::string& log) {
  return !request.continued.empty() && lies_in(request.continued, log);
}

void require_logs_elsewhere(const MapRequest& request) {
  for (const std::string& log : request.logs) {
    const bool is_folder = place_of_file(log) == place_of_file(request.folder) && std::filesystem::is_directory(log);
    if (log == "-" || is_of_continued_run(request, log) || !(is_folder || lies_in(request.folder, log))) continue;
    throw UsageError(fmt::format("'{}' lies in the folder that would be replaced; give another folder", one_line(log)));
  }
}

/// One run from the logs of a request to its folder, step by step.
class LogRun {
 public:
  LogRun(MapRequest request, const BackendOfRun& backend_of)
      : asked_{.request = request, .logs = {}}, request_(std::move(request)), backend_of_(backend_of) {
    require_logs_elsewhere(request_);
    for (const std::string& log : request_.logs) states_.push_back(state_of_file(log));
    findings_ = look_at_ranges(request_);
    folder_ = std::make_unique<RunFolder>(request_.folder, request_.replace_foreign_files);
    streams_.resize(request_.logs.size());
    for (const std::string& log : folder_->left_logs()) {
      if (request_.warn) {
        request_.warn(fmt::format("warning: a run that was killed left its log, which is kept as {}", log));
      }
    }
  }

  MapResult run() {
    try {
      ScanStream scans(request_.logs, read_options(), request_.range, [this](std::size_t log) { return open(log); });
      const NodKind kind = nod_kind_of_start(request_, scans);
      const bool has_work =
          kind != NodKind::kNone || matcher_info(request_.settings.mapper.match.matcher).always_searches;
      Backend& backend = backend_of_(has_work);
      prepare(kind, scans);
      return write(map(std::move(scans), backend), backend.device());
    } catch (const Error& error) {
      if (error.code() == ExitCode::kInterrupted && scans_ == 0) throw;
      rethrow_with(keep_streams());
    } catch (const std::bad_alloc&) {
      rethrow_with(keep_streams());
    }
  }

 private:
  // Made anew each time, because times of beams and the limit of ranges may be corrected.
  [[nodiscard]] ReadOptions read_options() const { return read_options_of(request_.settings.log, request_.lenient); }

  std::unique_ptr<LogReader> open(std::size_t log) {
    const std::string& name = request_.logs[log];
    std::unique_ptr<LogReader> reader =
        request_.live_log ? request_.live_log(read_options()) : open_log(name, read_options());
    if (!request_.with_continue_file || !(request_.live_log || is_stream(name))) return reader;
    streams_[log] = std::make_shared<StreamFile>(folder_->staged_path(kept_log_name(log)));
    return std::make_unique<KeptStream>(std::move(reader), streams_[log]);
  }

  // Reads what mapping needs before the first scan: the linkage of a laser that nods, else times of beams and odometry.
  void prepare(NodKind kind, ScanStream& scans) {
    if (kind == NodKind::kNone && request_.settings.nodding.dof == PoseFreedom::kSpace) {
      throw InputError(FilePosition{log_name(request_.logs.front()), 0},
                       "does not tell how the laser nods, which poses in space (--dof 6, nod.poses) need");
    }
    if (kind == NodKind::kNone) {
      const RunPreparation prepared = look_at_motion(request_, request_.logs.front());
      delay_ = prepared.delay;
      if (delay_) scans.set_odometry_delay(delay_->delay_s);
      findings_.insert(findings_.end(), prepared.findings.begin(), prepared.findings.end());
    } else {
      nodding_ = nodding_job(request_, kind);
    }
    scans.set_beam_times(read_options());
  }

  MapResult map(ScanStream scans, Backend& backend) {
    std::unique_ptr<CloudOutput> cloud;
    if (nodding_ && request_.with_cloud) {
      cloud = std::make_unique<CloudOutput>(request_.settings.cloud, folder_->staged("cloud.ply"));
    }
    run_ = std::make_unique<MapRun>(request_, backend, std::move(scans), nodding_ ? &*nodding_ : nullptr,
                                    std::move(cloud));
    MapResult result;
    times_.add("prepare");
    const auto progress = [this](std::uint64_t mapped, double share) {
      scans_ = mapped;
      if (request_.progress) request_.progress(mapped, share);
    };
    result.outcome = run_->run(progress, [this] { return request_.stop && request_.stop(); });
    times_.skip();  // the stages of mapping are in the outcome
    for (const auto& stream : streams_) {
      if (stream) stream->sync();
    }
    result.outcome.findings = findings_;
    result.outcome.odometry_delay = delay_;
    if (!nodding_) {
      const auto& stream = streams_.front();
      look_afterwards(request_, stream ? stream->path() : request_.logs.front(), result.outcome);
    }
    return result;
  }

  MapResult write(MapResult result, const DeviceInfo& device) {
    const WrittenField field = write_field(result.outcome);
    if (nodding_) {
      result.linkage = nodding_->linkage;
      write_cloud_picture(result.outcome);
      write_linkage(folder_->staged("linkage.yaml"), nodding_->model);
    }
    if (request_.with_continue_file) write_inputs();
    result.report =
        write_run(*folder_, {request_, nodding_ ? &*nodding_ : nullptr, field, device}, times_, result.outcome);
    return result;
  }

  // Frees the mapper's memory for the pictures and for the tiles of a large map.
  WrittenField write_field(MapOutcome& outcome) {
    const auto end_mapping = [this] {
      run_.reset();
      return_free_memory();
    };
    if (outcome.is_in_tiles) {
      end_mapping();
      return write_run_tiles(*folder_, request_, times_, outcome);
    }
    WrittenField field = write_run_field(*folder_, request_, run_->field(), times_);
    end_mapping();
    return field;
  }

  // Draws the cloud as a picture. A run without one, if nothing can draw, is still complete.
  void write_cloud_picture(MapOutcome& outcome) {
    if (request_.draw_cloud && request_.with_cloud && request_.with_pictures && !outcome.interrupted) {
      try {
        if (request_.finishing) request_.finishing("cloud.png");
        const calib::SweepModel* const linkage = nodding_->kind == NodKind::kEncoder ? &nodding_->model : nullptr;
        const std::string png =
            request_.draw_cloud(folder_->staged_path("cloud.ply"), request_.logs.front(), outcome.trajectory, linkage);
        write_file_atomically(folder_->staged("cloud.png"), png);
      } catch (const Error& error) {
        if (error.code() == ExitCode::kInputOutput) throw;
        outcome.warnings.push_back({"no picture of the cloud", 1, error.what()});
      }
    }
    times_.add("write_cloud_picture");
  }

  // Writes continue.json, and the logs that nobody can read again.
  void write_inputs() {
    for (std::size_t log = 0; log < request_.logs.size(); ++log) {
      const std::string& name = request_.logs[log];
      const bool comes_along = is_of_continued_run(request_, name);
      const std::string kept = streams_[log] || comes_along ? folder_->staged(kept_log_name(log)) : std::string();
      if (comes_along) copy_file_atomically(name, kept);
      asked_.logs.push_back(kept_log(name, states_[log], kept));
    }
    write_continue_file(folder_->staged(kContinueFile), asked_);
  }

  // Called when an exception ends the run: nobody can read the scans of streams again.
  std::string keep_streams() {
    std::string text;
    for (std::size_t log = 0; log < streams_.size(); ++log) {
      if (!streams_[log] || !streams_[log]->has_scan()) continue;
      try {
        streams_[log]->sync();
      } catch (const FileError&) {  // same as with a full disk: everything written before is there
      }
      text += "; what was read is kept: gdtslam map " + folder_->keep_log(kept_log_name(log)) + " makes a map of it";
    }
    return text;
  }

  [[noreturn]] void rethrow_with(const std::string& kept) const {
    if (kept.empty()) throw;
    try {
      throw;
    } catch (const InputError& error) {
      if (error.has_position()) throw Error(error.code(), error.what() + kept);
      throw InputError(FilePosition{log_name(request_.logs.front()), 0}, error.what() + kept);
    } catch (const Error& error) {
      throw Error(error.code(), error.what() + kept);
    } catch (const std::bad_alloc&) {
      throw Error(ExitCode::kFailed, "out of memory" + kept);
    }
  }

  KeptRequest asked_;
  MapRequest request_;
  const BackendOfRun& backend_of_;
  RunTimes times_;
  std::vector<std::optional<FileState>> states_;  ///< each log when the run began
  std::vector<LogFinding> findings_;
  std::optional<OdometryDelay> delay_;
  std::unique_ptr<RunFolder> folder_;
  std::vector<std::shared_ptr<StreamFile>>
      streams_;  ///< for each log, the file that keeps it; null if it can be read again
  std::optional<NoddingJob> nodding_;
  std::unique_ptr<MapRun> run_;
  std::uint64_t scans_ = 0;  ///< mapped scans
};

}  // namespace

MapResult map_logs(const MapRequest& request, const BackendOfRun& backend) {
  try {
    return LogRun(request.continued.empty() ? request : continued_request(request), backend).run();
  } catch (const InputError& error) {  // an input that a signal ended before the first scan is not bad
    require_not_stopped(request);
    if (error.has_position()) throw;
    throw InputError(FilePosition{request.logs.empty() ? request.continued : log_name(request.logs.front()), 0},
                     error.what());
  } catch (const MissingTopic&) {
    require_not_stopped(request);
    throw;
  }
}

}  // namespace gdtslam
