// gdtslam localize: proven poses of a log's scans in a map, without odometry.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "engine/runs/localizer/localize_log.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/localize/localize.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

constexpr double kMostSeconds = 1.0e5;  // 28 hours
constexpr double kMostGap_m = 1.0;
constexpr double kMostFit_m = 10.0;

LocalizeJob make_job(const LocalizeOptions& options, const Settings& settings) {
  LocalizeJob job;
  job.log = options.log;
  LogConfig log = settings.log;
  state_recording(options.recording, log);
  job.read = read_options_of(log, options.lenient);
  job.choice = options.choice;
  job.threads = options.device.threads > 0 ? options.device.threads : std::max(1U, std::thread::hardware_concurrency());
  return job;
}

void check(const LocalizeOptions& options) {
  if (looks_like_map(options.log) && !looks_like_map(options.map)) {
    throw UsageError(fmt::format("'{0}' is a map and '{1}' is none; the map comes first: gdtslam localize {0} {1}",
                                 options.log, options.map));
  }
  if (!options.picture.empty()) check_drawing_file("--picture", options.picture);
  WrittenFiles written({options.log, options.map, options.settings.file}, options.force);
  written.add("--output", options.trajectory);
  written.add("--picture", options.picture);
  written.add("--table", options.table);
  if (options.changes.empty()) return;
  check_drawing_file("--changes", options.changes);
  written.add("--changes", options.changes);
  written.add("--changes", changes_table_file(options.changes));
}

Trajectory found_poses(const Localized& all) {
  Trajectory trajectory;
  for (const LocalizedScan& scan : all.scans) {
    if (scan.best) trajectory.push_back({scan.stamp_s, scan.best->T_map_base});
  }
  return trajectory;
}

void require_found(const Localized& all) {
  const bool are_found = std::all_of(all.scans.begin(), all.scans.end(),
                                     [](const LocalizedScan& scan) { return scan.verdict == Verdict::kFound; });
  if (are_found) return;
  throw Error(ExitCode::kFailed, "--strict: not every scan was found: " + verdicts_text(all.scans));
}

// Each thread takes whole scans, so a scan's kernels run on a single thread.
std::unique_ptr<Backend> make_search_backend(DeviceOptions options) {
  options.threads = 1;
  return make_backend(options);
}

struct Work {
  std::unique_ptr<Backend> backend;
  std::unique_ptr<Localizer> localizer;
  Localized all;
};

Work work_with(const LocalizeOptions& options, const Settings& settings, const LocalizeJob& job,
               const DeviceOptions& device) {
  Work work;
  work.backend = make_search_backend(device);
  work.localizer = std::make_unique<Localizer>(options.map, settings.mapper, search_limits(options), *work.backend);
  ProgressLine progress("scans", options.quiet);
  work.all = localize_scans(
      job, *work.localizer, [&progress](std::uint64_t scans, double share) { progress.update(scans, share); },
      [] { return interrupted(); });
  return work;
}

int localize(const LocalizeOptions& options) {
  check(options);
  Stopwatch watch;
  LocalizeTimes times;
  const Settings settings = load_settings(options.settings);
  const LocalizeJob job = make_job(options, settings);
  if (options.track) return track(options, settings, job);
  const Work work = with_device(options.device,
                                [&](const DeviceOptions& device) { return work_with(options, settings, job, device); });
  const Localized& all = work.all;
  watch.add_to(times.wall_s, times.cpu_s);
  write_results(options, *work.localizer, all, found_poses(all), table_text(all.scans));
  print_remarks(all);
  if (options.json) {
    times.device = work.backend->device().name;
    print_result(json_text(as_json(job, *work.localizer, all, times)));
  } else if (!options.quiet) {
    print_result(as_text(*work.localizer, all));
  }
  if (all.interrupted) return static_cast<int>(ExitCode::kInterrupted);
  const bool is_any =
      std::any_of(all.scans.begin(), all.scans.end(), [](const auto& scan) { return scan.best.has_value(); });
  if (!is_any)
    throw InputError({options.log, 0}, std::string("none of the scans could be localised: too few returns") +
                                           (options.max_seconds > 0.0 ? ", or --max-time too short" : ""));
  if (options.strict) require_found(all);
  return static_cast<int>(ExitCode::kDone);
}

void add_choices(CLI::App& command, LocalizeOptions& chosen) {
  ScanChoice& choice = chosen.choice;
  add_count_option(command, "--scan", choice.first, 0, "Index of the scan, from 0; with --every the first one")
      ->capture_default_str();
  add_count_option(command, "--every", choice.every, 1, "Go on to the end of the log with every N-th scan");
}

void add_tracking_options(CLI::App& command, LocalizeOptions& chosen) {
  CLI::Option* track =
      command.add_flag("--track", chosen.track,
                       "Follow the robot from scan to scan with odometry, from a start that is found by itself");
  track->excludes("--every")->excludes("--no-runner-up");
  command
      .add_option("--changes", chosen.changes,
                  "Draw what is new and what is gone in the map: .svg, .png or .pdf, with a table of its cells, .csv,\n"
                  "beside it")
      ->type_name("FILE")
      ->needs(track);
}

void add_search_options(CLI::App& command, LocalizeOptions& chosen) {
  add_quantity_option(command, "--gap", chosen.gap_m, Unit::kMetre, {0.0, kMostGap_m},
                      "Prove that no pose has a mean distance smaller by more than this")
      ->default_str(format_quantity(chosen.gap_m, Unit::kMetre));
  add_quantity_option(command, "--max-time", chosen.max_seconds, Unit::kSecond, {1.0e-6, kMostSeconds},
                      "Give a search up after this long (default: never)");
  add_quantity_option(
      command, "--poor-fit", chosen.poor_fit_m, Unit::kMetre, {0.0, kMostFit_m},
      "A larger mean distance is a poor fit (default: two cells of the map, or more where more than 1 of\n"
      "100 of the run's own scans leave more in it)");
  command.add_flag("--strict", chosen.strict, "Exit 1 where a scan is not found: ambiguous, a poor fit, or no pose");
  command.add_flag("--no-runner-up", chosen.no_runner_up, "Do not look for the best pose elsewhere");
}

void add_output_options(CLI::App& command, LocalizeOptions& chosen) {
  command.add_option("-o,--output", chosen.trajectory, "Write the poses as a trajectory, TUM")->type_name("FILE");
  command
      .add_option("--table", chosen.table,
                  "Write a line for every scan, CSV: the pose and how well it is known, for 'gdtslam evaluate'")
      ->type_name("FILE");
  command.add_option("--picture", chosen.picture, "Draw the poses on the map: .svg, .png or .pdf")->type_name("FILE");
  command.add_flag("--lenient", chosen.lenient, "Count and skip malformed lines of the log");
  add_recording_options(command, chosen.recording);
  add_force_option(command, chosen.force);
  command.add_flag("--json", chosen.json, "Print JSON; what depends on the machine is under \"times\"");
  command.add_flag("-q,--quiet", chosen.quiet, "Print errors only");
}

}  // namespace

LocalizeLimits search_limits(const LocalizeOptions& options) {
  LocalizeLimits limits{.gap_m = options.gap_m, .max_seconds = {}, .with_runner_up = !options.no_runner_up};
  if (options.poor_fit_m >= 0.0) limits.good_fit_m = options.poor_fit_m;
  if (options.max_seconds > 0.0) limits.max_seconds = options.max_seconds;
  return limits;
}

void add_localize_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<LocalizeOptions>();
  CLI::App* command = add_command(app, "localize", "The pose of scans in a whole map, with a proof, or a drive in it");
  command
      ->add_option("map", options->map,
                   "Run folder of `gdtslam map`, its gdt.yaml, or the map.yaml of an occupancy map\n"
                   "(ROS map_server, Nav2)")
      ->required()
      ->type_name("MAP");
  command->add_option("log", options->log, "Log with the scans, plain or gzip")->required()->type_name("LOG");
  add_choices(*command, *options);
  add_search_options(*command, *options);
  add_tracking_options(*command, *options);
  add_device_options(*command, options->device);
  add_output_options(*command, *options);
  add_settings_options(*command, options->settings);
  command->footer(
      "All poses in the rectangle around the map's obstacles and map.truncation beyond (0.5 m) are searched, in every\n"
      "heading, by branch and bound: the result is the pose of least mean distance between the scan's points and the\n"
      "map's obstacles, up to the gap. Elsewhere means 1 m or 20 degrees away; a scan is ambiguous when a pose\n"
      "elsewhere may be as good, or where that took too long to tell, and a poor fit when even the best pose leaves a\n"
      "larger mean distance than scans of the mapped place do: it was taken elsewhere.\n"
      "\n"
      "Of an occupancy map the occupied cells are the obstacles, at the map's own resolution; distances to them are\n"
      "kept up to map.truncation.\n"
      "\n"
      "'gdtslam evaluate TABLE --reference TRUTH' compares the poses of a table with known ones.\n"
      "\n"
      "Examples:\n"
      "  gdtslam localize intel intel.clf.gz --scan 5000\n"
      "  gdtslam localize intel/gdt.yaml today.clf.gz --every 50 -o poses.tum --json\n"
      "  gdtslam localize warehouse/map.yaml today.bag --every 50 --picture poses.png\n"
      "  gdtslam localize intel intel.clf.gz --every 20 --table poses.csv\n"
      "  gdtslam localize intel today.clf.gz --track -o track.tum --table track.csv --picture track.png\n"
      "  gdtslam localize intel today.clf.gz --track --changes changes.png");
  command->callback([&context, options] { context.run = [options] { return localize(*options); }; });
}

}  // namespace gdtslam
