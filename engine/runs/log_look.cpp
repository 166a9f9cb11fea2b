#include "log_look.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <span>

#include "engine/runs/streams/no_return.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "engine/runs/streams/scan_ahead.hpp"
#include "engine/runs/streams/scan_motion.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kDoubtfulShare = 10;  // one scan in this many

bool has_stopped(const MapRequest& request) { return request.stop && request.stop(); }

void add(std::vector<LogFinding>& findings, const std::vector<LogFinding>& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

// Runs without loops are for comparison with other programs, so no delay is measured for them.
bool is_motion_known(const MapRequest& request) {
  return !request.live_log && request.with_loops && are_plain_files(request.logs) &&
         request.settings.log.odometry_stamps == OdometryStamps::kMeasured;
}

std::optional<OdometryDelay> odometry_delay(const MapRequest& request, std::span<const TimedMotion> motions) {
  const LogConfig& log = request.settings.log;
  if (log.odometry_stamps == OdometryStamps::kStated) return OdometryDelay{.delay_s = log.odometry_delay_s};
  std::optional<OdometryDelay> delay = estimate_delay(to_headings(motions));
  if (!delay || !delay->stands_out()) return std::nullopt;
  if (request.warn) {
    request.warn(
        fmt::format("odometry is stamped {:.2f} s {} than the scans that it belongs to (+-{:.3f} s), which is "
                    "made up for; log.odometry_stamps=log leaves it",
                    std::fabs(delay->delay_s), delay->delay_s < 0.0 ? "earlier" : "later", delay->sigma_s));
  }
  return delay;
}

// States the found times, so that every later reading of the logs uses them.
void state_times(const ReadOptions& read, LogConfig& log) {
  if (!read.first_beam_after_s || !read.beam_period_s) return;
  log.beam_times = LogSource::kStated;
  log.first_beam_after_s = *read.first_beam_after_s;
  log.beam_period_s = *read.beam_period_s;
}

}  // namespace

std::vector<LogFinding> look_at_ranges(MapRequest& request) {
  if (request.live_log) return {};
  return take_no_return(request.logs, request.range, request.lenient, request.settings,
                        [&request] { return has_stopped(request); });
}

RunPreparation look_at_motion(MapRequest& request, const std::string& log) {
  LogConfig& config = request.settings.log;
  if (request.live_log || !request.with_loops || config.odometry_stamps != OdometryStamps::kMeasured) {
    return {.delay = odometry_delay(request, {}), .findings = {}};
  }
  ReadOptions read = read_options_of(config, request.lenient);
  const MotionLook look = look_at_motion_by_scans(log, read, request.range, request.settings.mapper,
                                                  [&request] { return has_stopped(request); });
  state_times(read, config);
  return {.delay = odometry_delay(request, look.faultless()), .findings = look.faults};
}

void look_afterwards(const MapRequest& request, const std::string& log, MapOutcome& outcome) {
  if (outcome.interrupted) return;
  const auto stop = [&request] { return !request.stop_ends_log && has_stopped(request); };
  if (request.live_log || !are_plain_files(request.logs)) {
    Settings settings = request.settings;
    std::vector<LogFinding> faults = take_no_return({log}, request.range, request.lenient, settings, stop);
    for (LogFinding& fault : faults) {
      fault.what += ", and were mapped as walls";
      fault.is_mended = false;
    }
    add(outcome.findings, faults);
  }
  const bool is_doubtful = kDoubtfulShare * outcome.doubtful.size() >= scans_of(outcome);
  if (is_motion_known(request) || !is_doubtful) return;
  add(outcome.findings, motion_findings(motion_by_scans(log, read_options_of(request.settings.log, request.lenient),
                                                        request.range, request.settings.mapper, stop)));
}

}  // namespace gdtslam
