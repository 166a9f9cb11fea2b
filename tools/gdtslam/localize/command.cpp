// gdtslam localize: where scans of a log were taken in a map, without odometry and with a proof.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "changes_output.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "options.hpp"
#include "output.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"
#include "tracking.hpp"

namespace gdtslam {
namespace {

constexpr double kMostSeconds = 1.0e5;  // 28 hours
constexpr const char* kUsualWithin = "10cm/1deg";
constexpr double kMostGap_m = 1.0;
constexpr double kMostFit_m = 10.0;

// "10cm/1deg"
void read_within(const std::string& text, LocalizeLimits& limits) {
  const std::size_t mark = text.find('/');
  if (mark == std::string::npos) {
    throw UsageError("--within: '" + text + "' is not DISTANCE/ANGLE, for example 10cm/1deg");
  }
  limits.within_m = quantity_of("--within", text.substr(0, mark), Unit::kMetre);
  limits.within_rad = quantity_of("--within", text.substr(mark + 1), Unit::kRadian);
  constexpr double kMost_m = 100.0;
  if (!(limits.within_m > 0.0 && limits.within_m <= kMost_m && limits.within_rad > 0.0 && limits.within_rad <= kPi)) {
    throw UsageError("--within: '" + text + "' is out of range: up to 100m/180deg, neither of them 0");
  }
}

LocalizeJob job_of(const LocalizeOptions& options, const Settings& settings) {
  LocalizeJob job;
  job.log = options.log;
  LogConfig log = settings.log;
  state_recording(options.recording, log);
  job.read = read_options_of(log, options.lenient);
  job.choice = options.choice;
  job.threads = options.device.threads > 0 ? options.device.threads : std::max(1U, std::thread::hardware_concurrency());
  if (options.leave_out_s >= 0.0) {
    job.run = run_of_map(options.map, "--leave-out");
    job.merged.emplace(*job.run, options.leave_out_s);
  }
  if (!options.reference.empty()) {
    job.reference.emplace(options.reference);
    if (options.align) {
      if (!job.run) job.run = run_of_map(options.map, "--align");
      job.reference->align(*job.run);
    }
    if (const std::size_t repeated = job.reference->count_repeated(); repeated > 0) {
      print_remark(
          fmt::format("warning: {}: {} have stamps that occur twice, a clock stepped back: scans at these are "
                      "compared with none",
                      options.reference, plural(repeated, "pose")));
    }
  }
  return job;
}

// One scan alone has nothing to be chosen from.
void check(const LocalizeOptions& options) {
  if (looks_like_map(options.log) && !looks_like_map(options.map)) {
    throw UsageError(fmt::format("'{0}' is a map and '{1}' is none; the map comes first: gdtslam localize {0} {1}",
                                 options.log, options.map));
  }
  check_tracking(options);
  static_cast<void>(limits_of(options));  // what is no quantity is told before what is missing
  if (options.within && options.reference.empty()) {
    throw UsageError("--within is the distance to a reference: give --reference too");
  }
  const ScanChoice& choice = options.choice;
  if (options.leave_out_s >= 0.0 && choice.random == 0 && choice.every == 0) {
    throw UsageError("--leave-out chooses among scans: give --random or --every too");
  }
  if (!options.picture.empty()) check_drawing_file("--picture", options.picture);
  WrittenFiles written({options.log, options.reference, options.map, options.settings.file});
  written.add("--output", options.trajectory);
  written.add("--picture", options.picture);
  written.add("--table", options.table);
  if (options.changes.empty()) return;
  check_drawing_file("--changes", options.changes);
  written.add("--changes", options.changes);
  written.add("--changes", changes_table_file(options.changes));
}

void write_files(const LocalizeOptions& options, const LocalizeJob& job, const Localizer& localizer,
                 const Localized& all) {
  if (!options.trajectory.empty()) {
    Trajectory trajectory;
    for (const LocalizedScan& scan : all.scans) {
      if (scan.best) trajectory.push_back({scan.stamp_s, scan.best->T_map_base});
    }
    write_tum(options.trajectory, trajectory);
  }
  if (!options.picture.empty()) {
    write_file_atomically(options.picture,
                          drawing_bytes(localize_picture(job, localizer, all), options.picture, kDensePng));
  }
}

void print_remarks(const LocalizeJob& job, const Localized& all) {
  print_warnings(all.warnings);
  if (all.nods) {
    print_remark("warning: the laser of this log nods; a scan is found where it was taken nearly level only");
  }
  if (job.choice.random > all.scans.size() && !all.interrupted) {
    print_remark(
        fmt::format("warning: only {} could be drawn, not {}", plural(all.scans.size(), "scan"), job.choice.random));
  }
  if (job.merged && all.left_out == 0 && !all.interrupted) {
    print_remark("warning: no scan of the log lies near one that went into the map; was the map made from it?");
  }
  if (all.interrupted) print_remark("interrupted after " + plural(all.scans.size(), "scan"));
}

void require_reference(const LocalizeJob& job, const Localized& all) {
  if (!job.reference || all.interrupted) return;
  for (const LocalizedScan& scan : all.scans) {
    if (scan.reference) return;
  }
  throw InputError({job.reference->file(), 0},
                   fmt::format("none of its {} poses has the stamp of a scan that was localised; do both belong to the "
                               "same log?",
                               job.reference->count()));
}

void require_found(const Localized& all, const LocalizeLimits& limits) {
  const LocalizeFigures figures = figures_of(all.scans, limits);
  const std::uint64_t found = figures.verdicts[static_cast<std::size_t>(Verdict::kFound)];
  if (found == all.scans.size()) return;
  throw Error(ExitCode::kFailed, "--strict: not every scan was found: " + as_text(figures.verdicts));
}

// Threads take scans, so none are left for the kernels of one.
std::unique_ptr<Backend> backend_of(DeviceOptions options) {
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
  work.backend = backend_of(device);
  work.localizer = std::make_unique<Localizer>(options.map, settings.mapper, limits_of(options), *work.backend);
  if (job.run) job.run->files().expect_unchanged();
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
  const LocalizeJob job = job_of(options, settings);
  if (options.track) return track(options, settings, job);
  const Work work = with_device(options.device,
                                [&](const DeviceOptions& device) { return work_with(options, settings, job, device); });
  const Localized& all = work.all;
  require_reference(job, all);
  watch.add_to(times.wall_s, times.cpu_s);
  write_files(options, job, *work.localizer, all);
  print_remarks(job, all);
  if (options.json) {
    times.device = work.backend->device().name;
    print_result(json_text(as_json(job, *work.localizer, all, times)));
  } else if (!options.quiet) {
    print_result(as_text(job, *work.localizer, all));
  }
  if (all.interrupted) return static_cast<int>(ExitCode::kInterrupted);
  const bool is_any =
      std::any_of(all.scans.begin(), all.scans.end(), [](const auto& scan) { return scan.best.has_value(); });
  if (!is_any)
    throw InputError({options.log, 0}, std::string("none of the scans could be localised: too few returns") +
                                           (options.max_seconds > 0.0 ? ", or --max-time too short" : ""));
  if (options.strict) require_found(all, work.localizer->limits());
  return static_cast<int>(ExitCode::kDone);
}

void add_choices(CLI::App& command, LocalizeOptions& chosen) {
  ScanChoice& choice = chosen.choice;
  CLI::Option* scan =
      add_count_option(command, "--scan", choice.first, 0, "Index of the scan, from 0; with --every the first one");
  scan->capture_default_str();
  CLI::Option* every =
      add_count_option(command, "--every", choice.every, 1, "Go on to the end of the log with every N-th scan");
  CLI::Option* random =
      add_count_option(command, "--random", choice.random, 1, "N scans of the whole log, drawn at random");
  random->excludes(scan)->excludes(every);
  add_count_option(command, "--seed", choice.seed, 0, "Seed of the random draw")->capture_default_str()->needs(random);
  add_quantity_option(command, "--leave-out", chosen.leave_out_s, Unit::kSecond, {0.0, kMostSeconds},
                      "Do not choose scans that were taken this near in time to one that went into the map;\n"
                      "needs the run folder; 0: leave out those that went into it themselves");
}

void add_tracking_options(CLI::App& command, LocalizeOptions& chosen) {
  CLI::Option* track =
      command.add_flag("--track", chosen.track,
                       "Follow the robot from scan to scan with odometry, from a start that is found by itself");
  track->excludes("--every")->excludes("--random")->excludes("--no-runner-up");
  command.add_option("--table", chosen.table, "Write a line for every scan followed, CSV")
      ->type_name("FILE")
      ->needs(track);
  command
      .add_option("--changes", chosen.changes,
                  "Draw what is new and what is gone in the map: .svg, .png or .pdf, with a table of its cells, .csv,\n"
                  "beside it")
      ->type_name("FILE")
      ->needs(track);
}

void add_reference_options(CLI::App& command, LocalizeOptions& chosen) {
  CLI::Option* reference =
      command.add_option("--reference", chosen.reference,
                         "True poses in the map's frame, TUM, plain or gzip, or a run: report the errors.\n"
                         "The run itself will do for the log that was mapped");
  reference->type_name("FILE");
  command
      .add_flag("--align", chosen.align,
                "Move the reference as a whole onto the run's own trajectory first, where its frame is another")
      ->needs(reference);
  command.add_option("--within", chosen.within, "Distance and angle to the reference within which a pose is right")
      ->type_name("D/A")
      ->default_str(kUsualWithin);
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
  command.add_option("--picture", chosen.picture, "Draw the poses on the map: .svg, .png or .pdf")->type_name("FILE");
  command.add_flag("--lenient", chosen.lenient, "Count and skip malformed lines of the log");
  add_recording_options(command, chosen.recording);
  command.add_flag("--json", chosen.json, "Print JSON; what depends on the machine is under \"times\"");
  command.add_flag("-q,--quiet", chosen.quiet, "Print errors only");
}

}  // namespace

LocalizeLimits limits_of(const LocalizeOptions& options) {
  LocalizeLimits limits{.gap_m = options.gap_m, .max_seconds = {}, .with_runner_up = !options.no_runner_up};
  if (options.poor_fit_m >= 0.0) limits.good_fit_m = options.poor_fit_m;
  if (options.max_seconds > 0.0) limits.max_seconds = options.max_seconds;
  read_within(options.within.value_or(kUsualWithin), limits);
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
  add_reference_options(*command, *options);
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
      "JSON: map, log, field, gap_m, window, choice (of the scans), interrupted, good_fit, verdicts, certified "
      "(counts),\n"
      "errors (against the reference: within, distance_m, angle_deg, faults), scans (scan, stamp_s, points, verdict,\n"
      "best, runner_up, ambiguous, reference), warnings, times. docs/howto/localize.md explains them.\n"
      "\n"
      "--track: JSON has whereabouts (counts), ambiguous, searches, unknown (stretches), errors, warnings, times, and\n"
      "with --changes changes (views, new, gone).\n"
      "\n"
      "Examples:\n"
      "  gdtslam localize intel intel.clf.gz --scan 5000\n"
      "  gdtslam localize intel/gdt.yaml today.clf.gz --every 50 -o poses.tum --json\n"
      "  gdtslam localize warehouse/map.yaml today.bag --every 50 --picture poses.png\n"
      "  gdtslam localize intel intel.clf.gz --random 200 --leave-out 0.5s --reference intel\n"
      "  gdtslam localize intel today.clf.gz --track -o track.tum --table track.csv --picture track.png\n"
      "  gdtslam localize intel today.clf.gz --track --changes changes.png\n"
      "  gdtslam localize office office.log --every 20 --reference office.truth.tum --align --picture poses.svg");
  command->callback([&context, options] { context.run = [options] { return localize(*options); }; });
}

}  // namespace gdtslam
