// Maps whole logs, as the command `map`.
#include <limits>
#include <memory>
#include <string>

#include "convert.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/runs/warning_text.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "guard.hpp"
#include "options.hpp"
#include "run.hpp"

namespace {

using namespace gdtslam;
using namespace gdtslam::c;

constexpr uint32_t kMapFlags = GDTSLAM_LENIENT | GDTSLAM_NO_LOOPS | GDTSLAM_NO_MAP | GDTSLAM_NO_PICTURES |
                               GDTSLAM_NO_CLOUD | GDTSLAM_REPLACE_FOREIGN;

/// Reports progress to the caller, and asks whether to end.
class Watcher {
 public:
  explicit Watcher(const gdtslam_map_request& request) : request_(request) {}
  void tell(const char* step, std::uint64_t scans, double share) {
    if (request_.progress != nullptr && request_.progress(request_.user_data, step, scans, share) != 0) ended_ = true;
  }
  void tell_scans(std::uint64_t scans, double share) {
    scans_ = scans;
    share_ = share;
    tell("scans", scans, share);
  }
  /// Repeats the last call, after a signal interrupts a wait for the next scan.
  bool wants_end_of_wait() {
    tell_scans(scans_, share_);
    return ended_;
  }
  [[nodiscard]] bool has_ended() const { return ended_; }

 private:
  const gdtslam_map_request& request_;
  std::uint64_t scans_ = 0;
  double share_ = -1.0;
  bool ended_ = false;
};

MapRequest make_request(const gdtslam_map_request& given, Watcher& watcher) {
  const auto has = [&given](uint32_t flag) { return (given.flags & flag) != 0; };
  const ThreadChoice threads = choose_threads(given.threads);
  MapRequest request{.folder = given.folder, .settings = read_settings(given.options)};
  for (std::size_t k = 0; k < given.log_count; ++k) {
    require(given.logs[k], "gdtslam_map_logs: a log");
    request.logs.emplace_back(given.logs[k]);
  }
  request.lenient = has(GDTSLAM_LENIENT);
  request.range = {given.skip, given.scan_count == 0 ? std::numeric_limits<std::uint64_t>::max() : given.scan_count};
  request.linkage = to_text(given.linkage);
  request.replace_foreign_files = has(GDTSLAM_REPLACE_FOREIGN);
  request.with_cloud = !has(GDTSLAM_NO_CLOUD);
  request.with_map = !has(GDTSLAM_NO_MAP);
  request.with_loops = !has(GDTSLAM_NO_LOOPS);
  request.with_pictures = !has(GDTSLAM_NO_PICTURES);
  request.on_failure.cpu.threads = threads.count;
  request.on_failure.loops_beside = threads.loops_beside;
  request.progress = [&watcher](std::uint64_t scans, double share) { watcher.tell_scans(scans, share); };
  request.closing = [&watcher](std::string_view step, double share) {
    watcher.tell(std::string(step).c_str(), 0, share);
  };
  request.finishing = [&watcher](std::string_view what) { watcher.tell(std::string(what).c_str(), 0, -1.0); };
  request.stop = [&watcher] { return watcher.has_ended(); };
  if (given.warn != nullptr) {
    request.warn = [warn = given.warn, user = given.user_data](const std::string& text) { warn(user, text.c_str()); };
    request.on_failure.warn = request.warn;
  }
  return request;
}

void check(const gdtslam_map_request& given) {
  if ((given.flags & ~kMapFlags) != 0) throw UsageError("gdtslam_map_logs: a flag that means nothing here");
  require(given.logs, "gdtslam_map_logs: logs");
  if (given.log_count == 0) throw UsageError("gdtslam_map_logs: no log");
  require(given.folder, "gdtslam_map_logs: folder");
  if (*given.folder == '\0') throw UsageError("gdtslam_map_logs: the folder has no name");
}

void map_into(const gdtslam_map_request& given, gdtslam_run** run) {
  check(given);
  Watcher watcher(given);
  const MapRequest request = make_request(given, watcher);
  const std::unique_ptr<Backend> backend =
      make_cpu_backend({.threads = choose_threads(given.threads).count, .isa = {}});
  const AskedAfterSignals asked([&watcher] { return watcher.wants_end_of_wait(); });
  const MapResult result = map_logs(request, *backend);
  if (request.warn) {
    for (const LogReader::Warning& warning : result.outcome.warnings) request.warn(warning_text(warning));
    for (const LogFinding& finding : result.outcome.findings) request.warn(finding_text(finding));
  }
  if (run != nullptr) {
    auto made = std::make_unique<gdtslam_run>(request.folder);
    made->trajectory = to_c(result.outcome.trajectory);
    *run = made.release();
  }
  if (result.outcome.interrupted) {
    throw Error(ExitCode::kInterrupted, "interrupted after " + std::to_string(result.outcome.trajectory.size()) +
                                            " scans; their results are in " + request.folder);
  }
}

}  // namespace

gdtslam_status gdtslam_map_log(const char* log, const char* folder, gdtslam_run** run, gdtslam_error* error) {
  return guarded(error, [&] {
    if (run != nullptr) *run = nullptr;
    require(log, "gdtslam_map_log: log");
    require(folder, "gdtslam_map_log: folder");
    gdtslam_map_request request{};
    request.logs = &log;
    request.log_count = 1;
    request.folder = folder;
    map_into(request, run);
  });
}

gdtslam_status gdtslam_map_logs(const gdtslam_map_request* request, gdtslam_run** run, gdtslam_error* error) {
  return guarded(error, [&] {
    if (run != nullptr) *run = nullptr;
    constexpr std::size_t kLeast = GDTSLAM_SIZE_WITH(gdtslam_map_request, folder);
    map_into(read_struct(request, kLeast, "gdtslam_map_logs: request"), run);
  });
}
