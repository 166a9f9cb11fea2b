// gdtslam map: a log of laser and odometry to a map and a trajectory.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "console.hpp"
#include "device_failure.hpp"
#include "device_option.hpp"
#include "did_you_mean.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/mapping/matchers.hpp"
#include "interrupt.hpp"
#include "linkage_beside.hpp"
#include "linkage_file.hpp"
#include "map_logs.hpp"
#include "map_run.hpp"
#include "nodding_run.hpp"
#include "progress.hpp"
#include "render_cloud_picture.hpp"
#include "run_folder.hpp"
#include "run_output.hpp"
#include "run_report.hpp"
#include "settings.hpp"
#include "warning_list.hpp"
#include "whole_number.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostDoubtsShown = 5;

struct MapOptions {
  std::vector<std::string> logs;
  std::string folder;  ///< empty: runs/<log>-<UTC time>
  std::string matcher;
  SettingsOptions settings;
  DeviceOptions device;
  ScanRange range;
  std::string linkage;  ///< preset or file; empty: the file beside the log, else the default preset
  bool lenient = false;
  bool force = false;   ///< replace files of other origin in the folder
  bool no_cloud = false;
  bool no_pictures = false;
  bool json = false;
  bool quiet = false;
  bool with_summary = true;   ///< what was done, on standard output
  bool is_told = true;        ///< an interruption, on standard error
  MapRun::Progress progress;  ///< instead of the line on standard error
};

// --matcher is short for --set match.matcher and comes last, so that the command line beats the file.
Settings settings_of(const MapOptions& options) {
  SettingsOptions settings = options.settings;
  if (!options.matcher.empty()) settings.sets.push_back("match.matcher=" + options.matcher);
  return load_settings(settings);
}

// A device shows by its submissions that it did the work.
std::string work_of(const MapperStatistics& s) {
  const std::string dispatches = fmt::format("{} dispatches", s.dispatches);
  return s.submissions > 0 ? fmt::format("{} in {} submissions", dispatches, s.submissions) : dispatches;
}

std::string summary_of(const MapOutcome& outcome, const std::string& folder) {
  const MapperStatistics& s = outcome.statistics;
  const double rate = outcome.wall_s > 0.0 ? static_cast<double>(scans_of(outcome)) / outcome.wall_s : 0.0;
  return fmt::format(
      "{} scans, {} matched, {} doubtful, {} merged; {:.1f} m of path\n"
      "{:.2f} s ({:.0f} scans/s, {:.0f} times real time); {}\n"
      "results in {}\n",
      scans_of(outcome), s.matched, s.doubtful, s.keyframes, s.path_m, outcome.wall_s, rate,
      outcome.wall_s > 0.0 ? outcome.log_duration_s / outcome.wall_s : 0.0, work_of(s), folder);
}

std::string text_of(const DoubtfulScan& scan) {
  const std::string what = scan.accepted
                               ? fmt::format("the match is taken, {:.3f} m and {:.1f} deg from the prediction",
                                             scan.from_prediction_m, deg_from_rad(scan.from_prediction_rad))
                               : "the prediction is taken";
  return fmt::format("doubtful scan {} at {:.6f} s: {}; {}", scan.index, scan.stamp_s, name_of(scan.reason), what);
}

void print_remarks(const MapOutcome& outcome) {
  print_warnings(outcome.warnings);
  for (std::size_t k = 0; k < outcome.doubtful.size() && k < kMostDoubtsShown; ++k) {
    print_remark(text_of(outcome.doubtful[k]));
  }
  if (outcome.doubtful.size() > kMostDoubtsShown) {
    print_remark(
        fmt::format("and {} more doubtful scans; report.json lists all", outcome.doubtful.size() - kMostDoubtsShown));
  }
}

std::string text_of(const NoddingOutcome& nodding, const std::string& linkage) {
  const NoddingStatistics& n = nodding.statistics;
  std::string text = fmt::format("3D: linkage {}; {} sweeps, {} scans fixed the pose, {} posed between two fixes",
                                 linkage, n.sweeps, n.fixes, n.between);
  if (n.by_odometry + n.before_first_fix > 0) {
    text += fmt::format(", {} by odometry", n.by_odometry + n.before_first_fix);
  }
  if (nodding.has_cloud) {
    text += fmt::format("\n    {} points measured, {} in cloud.ply", nodding.cloud.measured, nodding.cloud.written);
  }
  if (const SweepCheck& check = nodding.check; check.pairs > 0) {
    text += fmt::format("\n    {} of {} sweeps held against the one before: {:.1f} mm and {:.3f} deg apart on average",
                        check.pairs, check.pairs + check.not_held, 1000.0 * check.mean_shift_m,
                        deg_from_rad(check.mean_turn_rad));
  } else if (check.not_held > 0) {
    text += fmt::format("\n    none of {} sweeps could be held against the one before", check.not_held);
  }
  return text + "\n";
}

void report_result(const MapOptions& options, const MapOutcome& outcome, const std::string& summary,
                   const std::string& report) {
  if (!options.quiet) print_remarks(outcome);
  if (options.json) {
    print_result(report);
  } else if (!options.quiet && options.with_summary) {
    print_result(summary);
  }
}

// A command that maps on its way to something else tells of its own interruption.
int status_of(const MapOptions& options, const MapOutcome& outcome, const std::string& folder) {
  if (!outcome.interrupted) return static_cast<int>(ExitCode::kDone);
  if (options.is_told)
    print_remark(fmt::format("interrupted after {} scans; their results are in {}", outcome.trajectory.size(), folder));
  return static_cast<int>(ExitCode::kInterrupted);
}

MapRun::Progress progress_of(const MapOptions& options, ProgressLine& line) {
  if (options.progress) return options.progress;
  return [&line](std::uint64_t done, double share) { line.update(done, share); };
}

int map_flat(const MapOptions& options, const MapJob& job, Backend& backend, ScanStream scans, Settings& settings,
             RunFolder& folder) {
  MapRun run(job, backend, std::move(scans));
  ProgressLine progress("scans", options.quiet);
  const MapOutcome outcome = run.run(progress_of(options, progress), [] { return interrupted(); });
  progress.clear();
  for (const char* name : {"cloud.ply", "cloud.png", "linkage.yaml"}) folder.without(name);
  const std::string report = write_run(folder, job, outcome, nullptr, run.mapper(), backend.device(), settings);
  report_result(options, outcome, summary_of(outcome, folder.path()), report);
  return status_of(options, outcome, folder.path());
}

// The cloud as a picture beside it. Where nothing can draw, the run is as good without.
void add_cloud_picture(const MapOptions& options, const NoddingJob& nodding, const std::string& cloud_file,
                       MapOutcome& outcome, RunFolder& folder) {
  if (!options.no_cloud && !options.no_pictures && !outcome.interrupted) {
    try {
      if (const auto png = cloud_picture_of_run(cloud_file, options.logs.front(), outcome.trajectory,
                                                nodding.kind == NodKind::kEncoder ? &nodding.model : nullptr)) {
        write_file_atomically(folder.staged("cloud.png"), *png);
        return;
      }
    } catch (const Error& error) {
      if (error.code() == ExitCode::kInputOutput) throw;
      outcome.warnings.push_back({"no picture of the cloud", 1, error.what()});
    }
  }
  folder.without("cloud.png");
}

int map_nodding(const MapOptions& options, const MapJob& job, const NoddingJob& nodding, Backend& backend,
                ScanStream scans, Settings& settings, RunFolder& folder) {
  std::unique_ptr<CloudOutput> cloud;
  std::string cloud_file;
  if (options.no_cloud) {
    folder.without("cloud.ply");
  } else {
    cloud_file = folder.staged("cloud.ply");
    cloud = std::make_unique<CloudOutput>(settings.cloud, cloud_file);
  }
  NoddingRun run(job, nodding, backend, std::move(scans), std::move(cloud));
  ProgressLine progress("scans", options.quiet);
  MapOutcome outcome = run.run(progress_of(options, progress), [] { return interrupted(); });
  progress.clear();
  add_cloud_picture(options, nodding, cloud_file, outcome, folder);
  write_linkage(folder.staged("linkage.yaml"), nodding.model);
  const NoddingReport extra{nodding, run.outcome()};
  const std::string report = write_run(folder, job, outcome, &extra, run.mapper(), backend.device(), settings);
  report_result(options, outcome, text_of(run.outcome(), nodding.linkage) + summary_of(outcome, folder.path()), report);
  return status_of(options, outcome, folder.path());
}

std::string text_of_default(NodKind kind, const NoddingJob& job) {
  if (kind == NodKind::kEncoder) {
    return fmt::format("warning: the laser nods and no --linkage is given: the preset {} is taken", job.linkage);
  }
  return fmt::format(
      "warning: the laser tilts and no --linkage is given: {:g} m over the floor, no lever arm, no time "
      "from beam to beam",
      job.model.mount.height_m);
}

// What was given, else the file that lies beside the log, else the default.
NoddingJob nodding_job_of(const MapOptions& options, const Settings& settings, NodKind kind) {
  NoddingJob job;
  job.kind = kind;
  job.nodding = settings.nodding;
  job.limits = settings.nod_limits;
  job.linkage = options.linkage.empty() ? linkage_beside(options.logs.front()) : options.linkage;
  if (job.linkage.empty()) {
    job.linkage = calib::kDefaultLinkage;
    job.model = resolve_linkage(job.linkage);
    if (kind == NodKind::kTilt) job.model.mirror_rate_hz = 0.0;  // of another laser; nobody knows when its beams fire
    if (!options.quiet) print_remark(text_of_default(kind, job));
    return job;
  }
  job.model = resolve_linkage(job.linkage);
  return job;
}

int map_logs(const MapOptions& options) {
  Settings settings = settings_of(options);
  if (!options.force && !options.folder.empty()) require_no_foreign_files(options.folder);
  const std::unique_ptr<Backend> backend = make_backend(options.device);
  const MapJob job{.logs = options.logs,
                   .read = read_options_of(settings.log, options.lenient),
                   .range = options.range,
                   .mapper = settings.mapper,
                   .occupancy = settings.occupancy,
                   .with_pictures = !options.no_pictures,
                   .on_failure = on_failure_of(options.device)};
  ScanStream scans(job.logs, job.read, job.range);
  // Where there is a linkage the mount's messages may be late in the log; else a live log is not kept waiting for them.
  const bool has_linkage = !options.linkage.empty() || !linkage_beside(options.logs.front()).empty();
  const NodKind kind = scans.nod_kind(has_linkage ? ScanStream::kMostAhead : ScanStream::kScansAhead);
  if (kind == NodKind::kNone && !options.linkage.empty()) {
    scans.expect_readable();
    throw InputError(
        FilePosition{log_name(options.logs.front()), 0},
        fmt::format("has no ENCODER or TILT message among its first {} records, so --linkage has nothing to work on",
                    ScanStream::kMostAhead));
  }
  RunFolder folder(options.folder.empty() ? default_run_folder(options.logs.front()) : options.folder);
  const int status = kind == NodKind::kNone ? map_flat(options, job, *backend, std::move(scans), settings, folder)
                                            : map_nodding(options, job, nodding_job_of(options, settings, kind),
                                                          *backend, std::move(scans), settings, folder);
  if (options.folder.empty()) link_latest(folder.path());
  return status;
}

int map(const MapOptions& options) {
  try {
    return map_logs(options);
  } catch (const InputError&) {  // an input that a signal ended before anything came is no bad input
    if (!interrupted()) throw;
    throw Error(ExitCode::kInterrupted, "interrupted before the first scan; nothing is written");
  }
}

void add_input_options(CLI::App& command, MapOptions& options) {
  command
      .add_option("log", options.logs, "CARMEN logs, plain or gzip, mapped one after the other; - is standard input")
      ->required()
      ->type_name("LOG");
  command.add_flag("--lenient", options.lenient, "Count and skip malformed lines instead of failing");
  command.add_option("--skip", options.range.skip, "Leave out the first N scans")
      ->type_name("N")
      ->check(whole_number_from(0));
  command.add_option("--first", options.range.count, "Map N scans only")->type_name("N")->check(whole_number_from(1));
}

}  // namespace

int map_log(const MapLogJob& job) {
  MapOptions options;
  options.logs = job.logs;
  options.folder = job.folder;
  options.linkage = job.linkage;
  options.no_pictures = job.is_temporary;
  options.is_told = !job.is_temporary;
  options.quiet = job.quiet;
  options.with_summary = false;
  options.settings.sets = job.sets;
  options.range = job.range;
  options.device = job.device;
  options.progress = job.progress;
  return map(options);
}

NodKind nod_kind_of(const std::vector<std::string>& logs) {
  ScanStream scans(logs, {}, {});
  const NodKind kind = scans.nod_kind(ScanStream::kMostAhead);
  scans.expect_readable();
  return kind;
}

void add_map_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* command =
      app.add_subcommand("map", "Map a log: occupancy map, distance field, trajectory, picture, 3D cloud, report");
  add_input_options(*command, *options);
  command
      ->add_option("-o,--output", options->folder,
                   "Folder of the results; made if need be, old results are replaced when all is done\n"
                   "(default: runs/<log>-<UTC time>, with a link runs/latest)")
      ->type_name("DIR");
  command->add_flag("--force", options->force, "Replace files of a run's names in DIR that no run wrote");
  add_settings_options(*command, options->settings);
  command
      ->add_option("--matcher", options->matcher,
                   fmt::format("{};\nshort for --set match.matcher=NAME", fmt::join(matcher_names(), ", ")))
      ->type_name("NAME")
      ->check([](const std::string& name) { return name.empty() ? std::string("names no matcher") : std::string(); },
              "");
  add_device_options(*command, options->device);
  command
      ->add_option("--linkage", options->linkage,
                   "Linkage of a nodding laser: a preset ('gdtslam linkage --list') or a file. Without it the file\n"
                   "LOG.linkage.yaml beside the log (LOG without .gz, .log, .clf) is taken, else the preset paper-b")
      ->type_name("NAME|FILE");
  command->add_flag("--no-cloud", options->no_cloud, "Do not write cloud.ply");
  command->add_flag("--no-pictures", options->no_pictures, "Do not write overview.png and cloud.png");
  command->add_flag("--json", options->json, "Print report.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes map.pgm and map.yaml (for ROS map_server and Nav2), gdt.png and gdt.yaml (the distance field),\n"
      "trajectory.tum, overview.png, config.yaml and report.json; where the log tells how the laser nods also\n"
      "cloud.ply, cloud.png and linkage.yaml. 'gdtslam render DIR' makes more pictures, films and pages.\n"
      "An interrupt (Ctrl-C, SIGTERM, a lost terminal) finishes the scan in hand and writes what there is, exit 130.\n"
      "\n"
      "Examples:\n"
      "  gdtslam map intel.clf.gz -o intel\n"
      "  gdtslam map intel.clf.gz -o fast --matcher gauss-newton --set search.when=suspect\n"
      "  gdtslam map office.log -c my.yaml --set map.resolution=\"10 cm\" --json | jq .scans_per_s\n"
      "  gdtslam map office-7f.log -o office --linkage paper-b --set cloud.voxel=\"5 cm\"\n"
      "  zcat drive.log.gz | gdtslam map - -o drive");
  command->callback([options, &context] {
    context.run = [options] { return map(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
