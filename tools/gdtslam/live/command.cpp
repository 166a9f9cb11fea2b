// gdtslam live: reads scans as lines and prints one line for each as soon as its pose is known.
#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "engine/core/scheduling.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "options.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

constexpr double kMostSeconds = 3600.0;

void check(const DriveOptions& options, bool has_log) {
  if (static_cast<int>(has_log) + static_cast<int>(!options.listen.empty()) +
          static_cast<int>(!options.follow.empty()) >
      1) {
    throw UsageError("LOG, --listen and --follow are three ways to say where scans come from: give one");
  }
  if (options.map.empty()) return;
  const auto refuse = [](const char* option) {
    throw UsageError(std::string(option) + " is of the map that is made, and with --map none is");
  };
  if (!options.folder.empty()) refuse("--output");
  if (options.snapshot_s > 0.0) refuse("--snapshot");
  if (options.no_map) refuse("--no-map");
  if (options.no_loops) refuse("--no-loops");
  if (options.no_pictures) refuse("--no-pictures");
}

void add_input_options(CLI::App& command, DriveOptions& options) {
  command
      .add_option("--listen", options.listen,
                  "Listen at unix:PATH, tcp:PORT of this host alone, or tcp:ADDRESS:PORT. One sender at a time sends\n"
                  "lines; when it has gone another may go on. Ends at SIGTERM or Ctrl-C")
      ->type_name("ADDRESS");
  command
      .add_option("--follow", options.follow, "Read a file that grows, from its beginning on, until SIGTERM or Ctrl-C")
      ->type_name("FILE");
  add_count_option(command, "--queue", options.queue, 1,
                   "Never let the sender wait: at most N scans wait to be mapped, and where one more comes the oldest\n"
                   "of them is dropped (default: nothing is dropped, and the sender waits)")
      ->type_name("N");
  command.add_flag("--lenient", options.lenient, "Count and skip malformed lines instead of failing");
  add_recording_options(command, options.recording);
}

void add_output_options(CLI::App& command, DriveOptions& options) {
  command
      .add_option("--map", options.map,
                  "Make no map: find the robot in this one, of any robot, and follow it. Run folder of\n"
                  "`gdtslam map`, its gdt.yaml, or the map.yaml of an occupancy map (ROS map_server, Nav2)")
      ->type_name("MAP");
  command
      .add_option("-o,--output", options.folder,
                  "Folder of the results, written when the scans have ended\n"
                  "(default: runs/<log>-<UTC time>, with a link runs/latest)")
      ->type_name("DIR");
  add_force_option(command, options.force);
  command
      .add_option("--snapshot", options.snapshot_s,
                  "Every so many seconds map and path so far, in DIR/snapshot (default: when SIGUSR1 comes)")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, kMostSeconds).description(""));
  command
      .add_option(
          "--page", options.page,
          "Show map, path and scan in a browser while the robot drives, at http://127.0.0.1:PORT/, to this host\n"
          "alone; 0 is any free port. ADDRESS:PORT serves it there, to whoever can reach it")
      ->type_name("[ADDRESS:]PORT");
  CLI::Option* const format =
      command
          .add_option("--format", options.format, "Format of the lines on standard output: json or tum (default: json)")
          ->type_name("NAME")
          ->check(CLI::IsMember({"json", "tum"}).description(""));
  offer_words(format, {"json", "tum"});
  command.add_flag("--no-map", options.no_map, "Do not cast the occupancy map, nor write the pictures of it");
  command.add_flag("--no-loops", options.no_loops, "Look for no loops");
  command.add_flag("--no-pictures", options.no_pictures, "Do not write overview.png and graph.png");
  command.add_flag("-q,--quiet", options.quiet, "No remarks on standard error");
}

}  // namespace

std::string input_name(const DriveOptions& options) {
  if (!options.listen.empty()) return options.listen;
  return options.follow.empty() ? options.log : options.follow;
}

std::shared_ptr<LiveInput> open_input(const DriveOptions& options) {
  if (!options.listen.empty()) return listen_at(options.listen);
  if (!options.follow.empty()) return follow_file(options.follow);
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(options.log, ignored);
  if (options.queue > 0 && is_folder) throw UsageError("--queue: " + options.log + " is a folder, which is not live");
  return options.queue > 0 ? open_stream(options.log) : nullptr;
}

// With a queue no thread waits for another; without one the reader may be slow, but must not hang.
LineOutput::Rule output_rule(const DriveOptions& options) {
  constexpr std::chrono::seconds kPatienceWithReader{5};
  if (options.queue > 0) return {.most_waiting = options.queue};
  return {.patience = kPatienceWithReader};
}

std::unique_ptr<LivePage> open_live_page(const DriveOptions& options) {
  if (options.page.empty()) return nullptr;
  std::unique_ptr<LivePage> page = open_page(options.page, "gdtslam live: " + log_name(input_name(options)));
  print_remark("the drive is shown at " + page->url());
  return page;
}

void print_remark_on_nods(const std::vector<LogReader::Warning>& warnings) {
  const bool nods = std::any_of(warnings.begin(), warnings.end(),
                                [](const auto& warning) { return warning.kind == ScanStream::kUnusedNods; });
  if (nods) print_remark("warning: the laser of this log nods, and live takes it for level; gdtslam map does not");
}

void add_live_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* command = add_command(app, "live", "Map while the robot drives: scans in as lines, a pose out for each");
  CLI::Option* log = command->add_option(
      "log", options->log,
      "Where scans and odometry come from, in any format that can be read from its beginning to its\n"
      "end (CARMEN lines are the simplest): - is standard input, which is the default; a named pipe");
  log->type_name("LOG");
  add_input_options(*command, *options);
  add_output_options(*command, *options);
  add_settings_options(*command, options->settings);
  add_device_options(*command, options->device);
  command->footer(
      "A line goes out as soon as a scan is mapped, before the next one is read. json: 'pose' never leaps, and\n"
      "'correction' says where its frame lies in the map with the loops closed that were found by then (ROS:\n"
      "odom -> base_link, map -> odom). tum: stamp x y z qx qy qz qw, with the correction. A reader that takes no "
      "line\n"
      "for 5 s (with --queue: at once) loses the oldest ones.\n"
      "When the scans end, at SIGTERM or Ctrl-C, or at a line that cannot be read (exit 65), loops are closed and the\n"
      "run folder is written, of the same bytes as that of 'gdtslam map' for the same input, unless the laser nods,\n"
      "which is taken for level; a second signal ends at once. The run keeps its input, log-1.jsonl.zst; of a drive\n"
      "that is killed or fails it stays beside DIR, and 'gdtslam map' maps it. SIGUSR1 saves map and path so far.\n"
      "\n"
      "Examples:\n"
      "  gdtslam live /run/laser.fifo -o drive\n"
      "  gdtslam live --listen unix:/run/laser.socket --snapshot 5 -o drive\n"
      "  gdtslam simulate office-loop -o - --pace 1 | gdtslam live -o drive --page 8080\n"
      "  gdtslam live --follow today.log --map warehouse/map.yaml\n"
      "  robot_logger | gdtslam live -o drive --format tum > poses.tum");
  command->callback([options, log, &context] {
    context.run = [options, has_log = log->count() > 0] {
      check(*options, has_log);
      answer_promptly();
      return options->map.empty() ? map_live(*options) : follow_live(*options);
    };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
