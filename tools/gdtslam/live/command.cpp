// gdtslam live: scans come in as lines, and a line goes out for each as soon as its pose is known.
#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include <algorithm>
#include <memory>
#include <string>

#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "pose_lines.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

struct LiveOptions {
  std::string log = "-";
  std::string folder;  ///< empty: runs/<log>-<UTC time>
  std::string format = std::string(kPoseLineFormats.front());
  SettingsOptions settings;
  DeviceOptions device;
  RecordingOptions recording;
  bool lenient = false;
  bool force = false;
  bool no_map = false;
  bool no_pictures = false;
  bool no_loops = false;
  bool no_copy = false;
  bool quiet = false;
};

MapRequest request_of(const LiveOptions& options, const PoseLines& lines) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  MapRequest request{.logs = {options.log},
                     .folder = options.folder.empty() ? default_run_folder(options.log) : options.folder,
                     .settings = std::move(settings),
                     .lenient = options.lenient,
                     .with_copies = !options.no_copy,
                     .replace_foreign_files = options.force,
                     .with_map = !options.no_map,
                     .with_loops = !options.no_loops,
                     .with_pictures = !options.no_pictures,
                     .on_failure = on_failure_of(options.device)};
  request.stop = [] { return interrupted(); };
  request.stop_ends_log = true;
  request.scan_mapped = [&lines, scan = std::uint64_t{0}](const MatchResult& match,
                                                          const Pose2& T_closed_front) mutable {
    lines.print(scan++, match, T_closed_front);
  };
  if (!options.quiet) request.warn = print_remark;
  return request;
}

// What there was by then is mapped and written.
int exit_code_of(const MapOutcome& outcome) {
  const bool broke_off = std::any_of(outcome.warnings.begin(), outcome.warnings.end(),
                                     [](const auto& warning) { return warning.kind == kBrokenOff; });
  return static_cast<int>(broke_off ? ExitCode::kBadInput : ExitCode::kDone);
}

int live(const LiveOptions& options) {
  const PoseLines lines(options.format);
  const MapRequest request = request_of(options, lines);
  BackendWhenNeeded backend(options.device);
  const MapResult result = map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  if (options.folder.empty()) link_latest(request.folder);
  if (options.quiet) return exit_code_of(result.outcome);
  print_remarks(result.outcome, request.folder);
  const MapperStatistics& s = result.outcome.statistics;
  print_remark(fmt::format("{} scans, {} matched, {} doubtful, {} merged; results in {}", scans_of(result.outcome),
                           s.matched, s.doubtful, s.keyframes, printable(request.folder)));
  return exit_code_of(result.outcome);
}

void add_output_options(CLI::App& command, LiveOptions& options) {
  command
      .add_option("-o,--output", options.folder,
                  "Folder of the results, written when the scans have ended\n"
                  "(default: runs/<log>-<UTC time>, with a link runs/latest)")
      ->type_name("DIR");
  command.add_flag("--force", options.force, "Replace files of a run's names in DIR that no run wrote");
  CLI::Option* const format =
      command
          .add_option("--format", options.format, "Format of the lines on standard output: json or tum (default: json)")
          ->type_name("NAME")
          ->check(CLI::IsMember({"json", "tum"}).description(""));
  offer_words(format, {"json", "tum"});
  command.add_flag("--no-map", options.no_map, "Do not cast the occupancy map, nor write the pictures of it");
  command.add_flag("--no-loops", options.no_loops, "Look for no loops");
  command.add_flag("--no-copy", options.no_copy, "Do not keep what is read: the run cannot be gone on with");
  command.add_flag("--no-pictures", options.no_pictures, "Do not write overview.png and graph.png");
  command.add_flag("-q,--quiet", options.quiet, "No remarks on standard error");
}

}  // namespace

void add_live_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App* command = add_command(app, "live", "Map while the robot drives: scans in as lines, a pose out for each");
  command
      ->add_option("log", options->log,
                   "Where scans and odometry come from, in any format that can be read from its beginning to its\n"
                   "end (CARMEN lines are the simplest): - is standard input, which is the default; a named pipe")
      ->type_name("LOG");
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines instead of failing");
  add_recording_options(*command, options->recording);
  add_output_options(*command, *options);
  add_settings_options(*command, options->settings);
  add_device_options(*command, options->device);
  command->footer(
      "A line goes out as soon as a scan is mapped, before the next one is read. json: 'pose' never leaps, and\n"
      "'correction' says where its frame lies in the map with the loops closed that were found by then (ROS:\n"
      "odom -> base_link, map -> odom). tum: stamp x y z qx qy qz qw, with the correction.\n"
      "When the scans end, at SIGTERM or Ctrl-C, or at a line that cannot be read (exit 65), loops are closed and the\n"
      "run folder is written, of the same bytes as that of 'gdtslam map' for the same input; a second signal ends at\n"
      "once. Killed, it goes on with 'gdtslam map --continue DIR'.\n"
      "\n"
      "Examples:\n"
      "  gdtslam live /run/laser.fifo -o drive\n"
      "  robot_logger | gdtslam live -o drive --format tum > poses.tum");
  command->callback([options, &context] {
    context.run = [options] { return live(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
