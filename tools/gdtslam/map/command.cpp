// gdtslam map: makes a map and a trajectory from a log of laser and odometry.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mapping/match/matchers.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_recording.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/map_progress.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"
#ifdef GDTSLAM_HAS_VIEWER
#include "tools/gdtslam/render/studio.hpp"
#endif

namespace gdtslam {
namespace {

struct MapOptions {
  std::vector<std::string> logs;
  std::string folder;  ///< empty: runs/<log>-<UTC time>
  std::string matcher;
  int dof = 0;  ///< 0: not stated
  SettingsOptions settings;
  DeviceOptions device;
  ScanRange range;
  std::string linkage;  ///< preset or file; empty: the file beside the log, else the default preset
  bool lenient = false;
  RecordingOptions recording;
  std::string mcap;       ///< empty: none
  std::string continued;  ///< folder of a run to continue; empty: a new run
  bool force = false;
  bool no_cloud = false;
  bool no_map = false;
  bool no_pictures = false;
  bool no_loops = false;
  bool json = false;
  bool quiet = false;
};

// Adds --set PATH=VALUE, for which `option` is short. If both are given they must agree.
void add_setting(const std::string& option, const std::string& path, std::string_view value,
                 std::vector<std::string>& sets) {
  const std::string stated = fmt::format("{}={}", path, value);
  for (const std::string& set : sets) {
    if (!set.starts_with(path + "=") || set == stated) continue;
    throw UsageError(fmt::format("{} contradicts --set {}: give one of them", option, set));
  }
  sets.push_back(stated);
}

Settings read_settings(const MapOptions& options) {
  SettingsOptions settings = options.settings;
  if (!options.matcher.empty()) {
    add_setting("--matcher " + options.matcher, "match.matcher", options.matcher, settings.sets);
  }
  if (options.dof != 0) {
    add_setting(fmt::format("--dof {}", options.dof), "nod.poses", options.dof == 6 ? "space" : "plane", settings.sets);
  }
  Settings loaded = load_settings(settings);
  state_recording(options.recording, loaded.log);
  return loaded;
}

// The work of a device; the CPU did the rest.
std::string device_work_text(const MapOutcome& outcome) {
  const QueueWork& all = outcome.statistics.device;
  if (all.submissions == 0) return {};
  return fmt::format("on the device: matching{}{}; {} dispatches, {:.1f} MB up, {:.1f} MB down, {:.2f} s of waiting\n",
                     outcome.adjusting.submissions > 0 ? ", adjustments" : "", outcome.nodding ? ", cloud" : "",
                     all.dispatch_sum(), 1e-6 * static_cast<double>(all.upload_bytes),
                     1e-6 * static_cast<double>(all.download_bytes), all.wait_s);
}

std::string loops_text(const ClosedPath& closed) {
  const auto on = std::count_if(closed.loops.begin(), closed.loops.end(), [](const ClosedLoop& l) { return l.is_on; });
  const std::string fit = closed.pairs > 0
                              ? fmt::format("points lie {:.1f} mm from the walls of other scans", 1000.0 * closed.rms_m)
                              : "no scan was laid on another";
  return fmt::format("loops: {} of {} hold; {}\n{}", on, closed.loops.size(), fit, uncertain_line(closed.covariances));
}

// `waited_s`: the user's whole waiting time; it adds the last files and those of --mcap to the time in report.json.
std::string summary_text(const MapOutcome& outcome, const std::string& folder, double waited_s) {
  const MapperStatistics& s = outcome.statistics;
  const double rate = waited_s > 0.0 ? static_cast<double>(scans_of(outcome)) / waited_s : 0.0;
  return fmt::format(
      "{}, {} matched, {} doubtful, {} merged; {:.1f} m of path\n"
      "{}{:.2f} s ({:.0f} scans/s, {:.0f} times real time)\n"
      "{}results in {}\n",
      plural(scans_of(outcome), "scan"), s.matched, s.doubtful, s.keyframes, s.path_m,
      outcome.closed ? loops_text(*outcome.closed) : "", waited_s, rate,
      waited_s > 0.0 ? outcome.log_duration_s / waited_s : 0.0, device_work_text(outcome), folder);
}

// Height and tilt of the robot, with their uncertainty.
std::string as_text(const SpaceOutcome& space) {
  const Tangent3& found = space.rms_correction;
  const auto part = [&](const char* name, Eigen::Index k) {
    return fmt::format("{} {:.2f} ± {:.2f} deg", name, deg_from_rad(found[k]), deg_from_rad(space.sigma[k]));
  };
  std::string text =
      fmt::format("\n    in space: height {:.1f} ± {:.1f} mm, {}, {} (root mean squares)", 1000.0 * found[2],
                  1000.0 * space.sigma[2], part("turns about x", 3), part("about y", 4));
  text += fmt::format("; surfaces of strokes {:.1f} mm apart, before {:.1f}", 1000.0 * space.rms_m,
                      1000.0 * space.rms_before_m);
  const auto [low, high] = std::minmax_element(space.elevation_knots_rad.begin(), space.elevation_knots_rad.end());
  if (*high > *low) {
    text += fmt::format("\n    elevation corrected by {:.2f} to {:.2f} deg", deg_from_rad(*low), deg_from_rad(*high));
  }
  return text;
}

std::string as_text(const NoddingOutcome& nodding, const std::string& linkage) {
  const NoddingStatistics& n = nodding.statistics;
  std::string text = fmt::format("3D: linkage {}; {}, {} fixed the pose, {} posed between two fixes", linkage,
                                 plural(n.sweeps, "sweep"), plural(n.fixes, "scan"), n.between);
  if (n.by_odometry + n.before_first_fix > 0) {
    text += fmt::format(", {} by odometry", n.by_odometry + n.before_first_fix);
  }
  if (nodding.has_cloud) {
    text += fmt::format("\n    {} points measured, {} in cloud.ply", nodding.cloud.measured, nodding.cloud.written);
  }
  if (nodding.space) text += as_text(*nodding.space);
  if (const SweepCheck& check = nodding.check; check.pairs > 0) {
    text += fmt::format("\n    {} of {} sweeps held against the one before: {:.1f} mm and {:.3f} deg apart on average",
                        check.pairs, check.pairs + check.not_held, 1000.0 * check.mean_shift_m,
                        deg_from_rad(check.mean_turn_rad));
  } else if (check.not_held > 0) {
    text += fmt::format("\n    none of {} sweeps could be held against the one before", check.not_held);
  }
  return text + "\n";
}

// Draws cloud.png; empty if this build cannot.
CloudPicture cloud_painter() {
#ifdef GDTSLAM_HAS_VIEWER
  return draw_run_cloud;
#else
  return {};
#endif
}

std::string result_folder(const MapOptions& options) {
  if (!options.folder.empty()) return options.folder;
  return options.continued.empty() ? default_run_folder(options.logs.front()) : options.continued;
}

MapRequest make_request(const MapOptions& options) {
  MapRequest request{.logs = options.logs,
                     .folder = result_folder(options),
                     .settings = read_settings(options),
                     .lenient = options.lenient,
                     .range = options.range,
                     .linkage = options.linkage,
                     .continued = options.continued,
                     .replace_foreign_files = options.force,
                     .with_cloud = !options.no_cloud,
                     .with_map = !options.no_map,
                     .with_loops = !options.no_loops,
                     .with_pictures = !options.no_pictures,
                     .on_failure = on_failure_of(options.device)};
  request.draw_cloud = cloud_painter();
  request.stop = [] { return interrupted(); };
  if (!options.quiet) request.warn = print_remark;
  return request;
}

void check_mcap(const MapOptions& options) {
  if (options.mcap.empty()) return;
  if (options.no_map) throw UsageError("--mcap writes the occupancy map, which --no-map leaves out: give one of them");
  if (std::find(options.logs.begin(), options.logs.end(), "-") != options.logs.end()) {
    throw UsageError("--mcap reads the logs twice: give files, not standard input");
  }
}

// A run that is continued in its own folder replaces itself.
void check_files(const MapOptions& options, const std::string& folder) {
  check_mcap(options);
  std::vector<std::string> inputs = options.logs;
  inputs.insert(inputs.end(), {options.settings.file, linkage_file_of(options.linkage)});
  for (const std::string& log : options.logs) inputs.push_back(linkage_sidecar(log));
  WrittenFiles written(inputs, options.force);
  if (folder != options.continued) written.add_folder("--output", folder);
  written.add("--mcap", options.mcap);
}

void write_mcap(const MapOptions& options, const MapRequest& request, const MapOutcome& outcome,
                MapProgress& progress) {
  if (options.mcap.empty()) return;
  progress.making(options.mcap);
  const ReadOptions read = read_options_of(request.settings.log, request.lenient);
  const std::size_t left_out = write_run_recording(options.mcap, request.logs, read, request.range, outcome);
  progress.clear();
  if (left_out > 0) {
    print_remark(fmt::format("{} scans are not in {}: ROS knows no stamps before 1970 or after 2038", left_out,
                             printable(options.mcap)));
  }
}

// A continued run keeps the options that determine its result.
void check_continued(const CLI::App& command, const MapOptions& options) {
  if (options.continued.empty()) {
    if (options.logs.empty()) throw CLI::RequiredError("log");
    return;
  }
  for (const char* name :
       {"--config", "--set", "--matcher", "--dof", "--linkage", "--lenient", "--topic", "--odom", "--crank", "--mount",
        "--skip", "--first", "--no-cloud", "--no-map", "--no-loops", "--no-pictures", "--mcap"}) {
    if (command.count(name) == 0) continue;
    throw UsageError(fmt::format("{}: a run that is continued keeps its configuration and parts: leave it out", name));
  }
}

int map(const MapOptions& options) {
  MapProgress progress(options.quiet);
  MapRequest request = make_request(options);
  check_files(options, request.folder);
  BackendWhenNeeded backend(options.device);
  progress.follow(request);
  const MapResult result = map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  progress.clear();
  write_mcap(options, request, result.outcome, progress);
  if (options.folder.empty() && options.continued.empty()) link_latest(request.folder);
  const double waited_s = progress.elapsed_s();
  if (!options.quiet) print_remarks(result.outcome, request.folder);
  if (options.json) {
    print_result(result.report);
  } else if (!options.quiet) {
    print_result((result.outcome.nodding ? as_text(*result.outcome.nodding, result.linkage) : "") +
                 summary_text(result.outcome, printable(request.folder), waited_s));
  }
  if (!result.outcome.interrupted) return static_cast<int>(ExitCode::kDone);
  print_remark(fmt::format("interrupted after {}; their results are in {}",
                           plural(result.outcome.trajectory.size(), "scan"), request.folder));
  return static_cast<int>(ExitCode::kInterrupted);
}

void add_input_options(CLI::App& command, MapOptions& options) {
  command
      .add_option("log", options.logs,
                  fmt::format("{} logs, plain or gzip, mapped one after the other; - is standard input", kLogFormats))
      ->type_name("LOG");
  command
      .add_option(
          "--continue", options.continued,
          "Continue the run in DIR with more logs: its own logs are read again, which must be as they were, with\n"
          "its configuration, and then these; the same results as all logs in one go. Results replace those in\n"
          "DIR, or go to -o")
      ->type_name("DIR");
  command.add_flag("--lenient", options.lenient, "Count and skip malformed lines instead of failing");
  add_recording_options(command, options.recording);
  add_count_option(command, "--skip", options.range.skip, 0, "Leave out the first N scans");
  add_count_option(command, "--first", options.range.count, 1, "Map N scans only");
}

}  // namespace

void add_map_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* command =
      add_command(app, "map", "Map a log: occupancy map, distance field, trajectory, picture, 3D cloud, report");
  add_input_options(*command, *options);
  command
      ->add_option("-o,--output", options->folder,
                   "Folder of the results; --force replaces what lies there as a whole when all is done\n"
                   "(default: runs/<log>-<UTC time>, with a link runs/latest)")
      ->type_name("DIR");
  add_force_option(*command, options->force);
  add_settings_options(*command, options->settings);
  CLI::Option* const matcher =
      command->add_option("--matcher", options->matcher,
                          fmt::format("How scans are matched with the map: {}; short for --set match.matcher=NAME",
                                      fmt::join(matcher_names(), ", ")));
  offer_words(matcher->type_name("NAME"), {matcher_names().begin(), matcher_names().end()})
      ->check([](const std::string& name) { return name.empty() ? std::string("names no matcher") : std::string(); },
              "");
  add_device_options(*command, options->device);
  command
      ->add_option("--linkage", options->linkage,
                   "Linkage of a nodding laser: a preset ('gdtslam linkage --list') or a file. Without it the file\n"
                   "LOG.linkage.yaml beside the log (LOG without its endings) is taken, else the preset paper-b")
      ->type_name("NAME|FILE");
  offer_words(command
                  ->add_option("--dof", options->dof,
                               "With a nodding laser: 6 also finds height, roll and pitch of the robot; short for\n"
                               "--set nod.poses=space (default: 3)")
                  ->check(CLI::IsMember({3, 6}).description("3 or 6"))
                  ->type_name("N"),
              {"3", "6"});
  command->add_flag("--no-cloud", options->no_cloud, "Do not write cloud.ply");
  command->add_flag("--no-map", options->no_map,
                    "Do not cast the occupancy map, nor write map.pgm, map.yaml and the pictures of it");
  command->add_flag(
      "--no-loops", options->no_loops,
      "Match each scan with one map of all that was seen; without it loops are closed and the whole path\n"
      "is adjusted once the log has ended");
  command->add_flag("--no-pictures", options->no_pictures, "Do not write overview.png, graph.png and cloud.png");
  command
      ->add_option(
          "--mcap", options->mcap,
          "Write map, poses and scans as an MCAP file of ROS 2 messages, too, for Foxglove, rerun and the like")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print report.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes map.pgm and map.yaml (for ROS map_server and Nav2), gdt.png and gdt.yaml (the distance field),\n"
      "trajectory.tum, keyframes.bin.gz (the scans in the map), overview.png, config.yaml and report.json;\n"
      "where loops are closed also covariance.csv, graph.g2o and graph.png, and where the log tells how the\n"
      "laser nods cloud.ply, cloud.png and linkage.yaml, but no keyframes.bin.gz. For --continue, continue.json; a "
      "log\n"
      "that came through a pipe is kept as log-N.jsonl.zst. 'gdtslam render DIR' makes more pictures, films and "
      "pages;\n"
      "'gdtslam doctor --after DIR' says what in the map is doubtful.\n"
      "An interrupt (Ctrl-C, SIGTERM, a lost terminal) finishes the scan in hand and writes what there is, exit 130.\n"
      "\n"
      "Examples:\n"
      "  gdtslam map intel.clf.gz -o intel\n"
      "  gdtslam map intel.clf.gz -o fast --matcher gauss-newton --set search.when=suspect\n"
      "  gdtslam map office.log -c my.yaml --set map.resolution=\"10 cm\" --json | jq .scans_per_s\n"
      "  gdtslam map office-7f.log -o office --linkage paper-b --set cloud.voxel=\"5 cm\"\n"
      "  gdtslam map --continue office tomorrow.log\n"
      "  zcat drive.log.gz | gdtslam map - -o drive");
  command->callback([command, options, &context] {
    check_continued(*command, *options);
    context.run = [options] { return map(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
