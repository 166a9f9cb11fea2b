// A drive that is mapped while it lasts.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "engine/core/memory/free_memory.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "options.hpp"
#include "page/page_figures.hpp"
#include "snapshot/snapshots.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

MapRequest make_request(const DriveOptions& options) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  const std::string log = input_name(options);
  MapRequest request{.logs = {log},
                     .folder = options.folder.empty() ? default_run_folder(log) : options.folder,
                     .settings = std::move(settings),
                     .lenient = options.lenient,
                     .replace_foreign_files = options.force,
                     .with_map = !options.no_map,
                     .with_loops = !options.no_loops,
                     .with_pictures = !options.no_pictures,
                     .on_failure = on_failure_of(options.device)};
  request.stop = [] { return interrupted(); };
  request.stop_ends_log = true;
  if (!options.quiet) request.warn = print_remark;
  return request;
}

/// Counts for the page.
struct Drive {
  DriveCounts counts;
  RateMeter meter;
  Pose2 T_front_last;

  void count(const MappedScan& mapped) {
    const Pose2& T = mapped.match.T_map_base;
    if (counts.scans > 0) counts.path_m += (T.translation() - T_front_last.translation()).norm();
    T_front_last = T;
    ++counts.scans;
    counts.keyframes += mapped.match.merged ? 1 : 0;
    counts.scans_per_s = meter.count();
  }
};

// After a problem, the scans before it are mapped and written.
int find_exit_code(const MapOutcome& outcome) {
  const std::string_view kind = warning_of_end(outcome.broken_off);
  const auto why = std::find_if(outcome.warnings.begin(), outcome.warnings.end(),
                                [&](const auto& warning) { return warning.kind == kind; });
  if (why == outcome.warnings.end()) return static_cast<int>(ExitCode::kDone);
  print_error(fmt::format("{}: {}", kind, why->first));
  return static_cast<int>(outcome.broken_off);
}

void print_summary(const MapRequest& request, const MapOutcome& outcome, std::uint64_t dropped_lines) {
  print_remarks(outcome, request.folder);
  print_remark_on_nods(outcome.warnings);
  const MapperStatistics& s = outcome.statistics;
  const std::string lines =
      dropped_lines > 0 ? fmt::format(", {} lines not read by anybody", dropped_lines) : std::string();
  print_remark(fmt::format("{}, {} matched, {} doubtful, {} merged{}; results in {}", plural(scans_of(outcome), "scan"),
                           s.matched, s.doubtful, s.keyframes, lines, printable(request.folder)));
}

}  // namespace

int map_live(const DriveOptions& options) {
  return_large_blocks_at_once();
  let_signal_save();
  MapRequest request = make_request(options);
  WrittenFiles({}, options.force).add_folder("--output", request.folder);
  require_no_foreign_snapshot(request.folder);
  if (auto input = open_input(options)) request.live_log = make_live_log(std::move(input), options.queue);
  LineOutput output(output_rule(options));
  DriveRecord record(request.settings.occupancy, occupancy_limits(request.settings.mapper));
  const std::unique_ptr<LivePage> page = open_live_page(options);
  request.scan_mapped = [&, format = parse_pose_format(options.format), valid = request.settings.mapper.scan,
                         drive = Drive()](const MappedScan& mapped) mutable {
    output.write(pose_line(format, drive.counts.scans, mapped));
    record.take(mapped);
    drive.count(mapped);
    if (page) page->show(shown_scan(drive.counts, valid, mapped));
  };
  Snapshots::Plan plan{.folder = request.folder, .every_s = options.snapshot_s, .is_quiet = options.quiet};
  if (page) {
    plan.is_watched = [&page] { return page->is_watched(); };
    plan.show = [&page](const DriveState& state) { page->show(state.map, state.trajectory); };
  }
  Snapshots snapshots(record, std::move(plan));
  snapshots.start();
  request.closing = [&snapshots](std::string_view, double) { snapshots.stop(); };
  request.finishing = [&snapshots](std::string_view) { snapshots.stop(); };  // called if no loops are closed
  BackendWhenNeeded backend(options.device);
  const MapResult result = map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  output.finish();
  if (options.folder.empty()) link_latest(request.folder);
  if (!options.quiet) print_summary(request, result.outcome, output.dropped());
  return find_exit_code(result.outcome);
}

}  // namespace gdtslam
