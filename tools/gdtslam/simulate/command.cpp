// gdtslam simulate: makes a log with ground truth from a scene.
#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"
#include "tools/gdtslam/scenes/simulate_run.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct SimulateCommand {
  SimulateOptions options;
  std::string noise;
  std::string resolution;
  std::string speed;
  std::string turn_rate;
  std::string elevation_error;
  std::string sway;
  double pace = 0.0;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

std::string list_files(const SimulateResult& result) {
  std::string text = fmt::format("log {}\ntruth {}\n", result.log_file, result.truth_file);
  if (!result.linkage_file.empty()) {
    text += fmt::format("linkage {}\nelevations {}\n", result.linkage_file, result.elevation_file);
  }
  if (!result.hits_file.empty()) {
    text += fmt::format("hits {}\n", result.hits_file);
  }
  return text;
}

std::string summary_text(const SimulateResult& result) {
  const double returns =
      result.beams > 0 ? static_cast<double>(result.returns) / static_cast<double>(result.beams) : 0.0;
  return fmt::format(
      "{}, {}{}; {:.1f} m in {:.1f} s; {:.2f} % of the beams returned\n"
      "{} triangles; nearest obstacle {:.2f} m from the robot's centre; simulated in {:.2f} s\n{}",
      plural(result.scans, "scan"), plural(result.odometry_records, "odometry line"),
      result.encoder_records > 0 ? ", " + plural(result.encoder_records, "encoder line") : "", result.path_m,
      result.duration_s, 100.0 * returns, result.triangles, result.clearance_m, result.wall_s, list_files(result));
}

Json name_or_null(const std::string& file) { return file.empty() ? Json(nullptr) : Json(file); }

Json to_json(const SimulateResult& result, std::uint64_t seed) {
  return {{"scene", result.scene_file},
          {"log", result.log_file},
          {"truth", result.truth_file},
          {"linkage", name_or_null(result.linkage_file)},
          {"elevations", name_or_null(result.elevation_file)},
          {"hits", name_or_null(result.hits_file)},
          {"seed", seed},
          {"scans", result.scans},
          {"odometry_lines", result.odometry_records},
          {"encoder_lines", result.encoder_records},
          {"beams", result.beams},
          {"returns", result.returns},
          {"triangles", result.triangles},
          {"log_bytes", result.log_bytes},
          {"duration_s", result.duration_s},
          {"path_m", result.path_m},
          {"clearance_m", result.clearance_m},
          {"wall_s", result.wall_s},
          {"interrupted", !result.is_whole}};
}

std::optional<double> parse_length(const char* option, const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(quantity_of(option, text, Unit::kMetre));
}

/// "0.8 m/s", "60 deg/s".
std::optional<double> parse_rate(const std::string& option, const std::string& text, Unit unit) {
  constexpr std::string_view kPerSecond = "/s";
  if (text.empty()) return std::nullopt;
  if (!text.ends_with(kPerSecond)) {
    throw UsageError(fmt::format("{}: {} needs a unit a second: {}", option, in_quotes(text),
                                 unit == Unit::kMetre ? "0.8 m/s" : "60 deg/s"));
  }
  return quantity_of(option, text.substr(0, text.size() - kPerSecond.size()), unit);
}

/// "0.4deg,1cm".
void parse_sway(const std::string& text, SimulateOptions& options) {
  if (text.empty()) return;
  const std::vector<std::string> words = words_between_commas(text);
  if (words.size() != 2) {
    throw UsageError(fmt::format("--sway: {} is not TILT,HEAVE: write 0.4deg,1cm", in_quotes(text)));
  }
  options.sway_tilt_rad = quantity_of("--sway", words[0], Unit::kRadian);
  options.sway_heave_m = quantity_of("--sway", words[1], Unit::kMetre);
}

/// Prints lines at their time, like a robot that runs `pace` times as fast; 0: at once.
class PacedLines {
 public:
  explicit PacedLines(double pace) : pace_(pace) {}
  void print(std::optional<double> stamp_s, std::string_view lines) {
    using Clock = std::chrono::steady_clock;
    if (stamp_s && pace_ > 0.0) {
      if (!first_s_) {
        first_s_ = *stamp_s;
        begin_ = Clock::now();
      }
      const std::chrono::duration<double> due((*stamp_s - *first_s_) / pace_);
      constexpr std::chrono::milliseconds kSlice{100};  // time between checks for a signal
      for (auto left = due - (Clock::now() - begin_); left.count() > 0.0 && !interrupted();
           left = due - (Clock::now() - begin_)) {
        std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(left, kSlice));
      }
    }
    has_reader_ = print_result(lines);
  }
  /// False once the reader has closed.
  [[nodiscard]] bool has_reader() const { return has_reader_; }

 private:
  double pace_;
  bool has_reader_ = true;
  std::optional<double> first_s_;
  std::chrono::steady_clock::time_point begin_;
};

void check_standard_output(const SimulateCommand& command) {
  const bool is_sent = command.options.output == "-";
  if (is_sent && command.json) throw UsageError("--json: standard output is where the log goes; give a file with -o");
  if (!is_sent && command.pace > 0.0) throw UsageError("--pace is of lines that are sent: -o -");
}

// Checks the log and the files beside it.
void check_files(const SimulateOptions& options, bool force) {
  (void)log_format_by_ending(options.output);  // throws for the name of a bag
  WrittenFiles written({find_scene(options.scene, options.scene_folders), options.trajectory.value_or(""),
                        linkage_file_of(options.linkage.value_or(""))},
                       force);
  written.add("--output", options.output);
  for (const char* ending : {".truth.tum", ".linkage.yaml", ".elevation.csv", ".truth.ply"}) {
    written.add("--output", sidecar_path(options.output, ending));
  }
}

int run_simulate(const SimulateCommand& command) {
  check_standard_output(command);
  SimulateOptions options = command.options;
  PacedLines lines(command.pace);
  const bool is_sent = options.output == "-";
  if (is_sent) {
    options.send = [&lines](std::optional<double> stamp_s, std::string_view text) { lines.print(stamp_s, text); };
  }
  options.speed_m_per_s = parse_rate("--speed", command.speed, Unit::kMetre);
  options.turn_rate_rad_per_s = parse_rate("--turn-rate", command.turn_rate, Unit::kRadian);
  if (!command.elevation_error.empty()) {
    options.elevation_error_rad = quantity_of("--elevation-error", command.elevation_error, Unit::kRadian);
  }
  parse_sway(command.sway, options);
  options.noise_m = parse_length("--noise", command.noise);
  options.range_resolution_m = parse_length("--resolution", command.resolution);
  ProgressLine progress("scans", command.quiet);
  options.scene_folders = asset_folders("scenes");
  if (!is_sent) check_files(options, command.force);
  options.progress = [&progress](std::uint64_t scans, double share) { progress.update(scans, share); };
  options.stop = [&lines] { return interrupted() || !lines.has_reader(); };
  const SimulateResult result = simulate(options);
  progress.clear();
  for (const LogReader::Warning& one : result.left_out) {
    if (!command.quiet)
      print_remark(fmt::format("the format of the log cannot carry: {} ({} times)", one.kind, one.count));
  }
  if (command.json) {
    print_result(json_text(to_json(result, options.seed)));
  } else if (!command.quiet && !is_sent) {
    print_result(summary_text(result));
  }
  if (result.is_whole || (!lines.has_reader() && !interrupted())) {
    return static_cast<int>(ExitCode::kDone);
  }
  const bool is_one = result.scans == 1;
  const char* const state = is_sent ? (is_one ? "was" : "were") : (is_one ? "is in" : "are in");
  print_remark(fmt::format("interrupted after {}, which {} {}", plural(result.scans, "scan"), state,
                           is_sent ? "sent" : result.log_file));
  return static_cast<int>(ExitCode::kInterrupted);
}

}  // namespace

void add_nodding_options(CLI::App& command, SimulateCommand& chosen) {
  SimulateOptions& options = chosen.options;
  command
      .add_option("--linkage", options.linkage,
                  "The laser nods on this linkage: a preset (see gdtslam linkage) or a linkage file")
      ->type_name("PRESET|FILE")
      ->group("Nodding");
  command
      .add_option("--nod", options.nod_mode,
                  "When the crank turns: continuous; stop-and-scan, while the robot stands; stepped, with a stop at "
                  "each step")
      ->type_name("MODE")
      ->group("Nodding");
  offer_words(command.get_option("--nod"), {"continuous", "stop-and-scan", "stepped"});
  command.add_option("--crank-rate", options.crank_rate_hz, "Turns of the crank a second")
      ->type_name("HZ")
      ->group("Nodding");
  command.add_option("--ticks", options.ticks_per_turn, "Ticks of the encoder per turn of the crank")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(1))
      ->group("Nodding");
  command
      .add_flag("--truth-hits", options.truth_hits,
                "Write every true hit, too, as NAME.truth.ply (60 bytes for each beam that returned)")
      ->group("Nodding");
}

void add_error_options(CLI::App& command, SimulateCommand& chosen) {
  command.add_option("--noise", chosen.noise, "Standard deviation of the ranges, instead of the laser's")
      ->type_name("LENGTH")
      ->group("Errors of the sensors");
  command.add_option("--resolution", chosen.resolution, "What ranges are rounded to; 0 keeps all digits")
      ->type_name("LENGTH")
      ->group("Errors of the sensors");
  command
      .add_option("--elevation-error", chosen.elevation_error,
                  "Root mean square of a smooth error of the laser's elevation over a turn of the crank, which the "
                  "linkage file does not have")
      ->type_name("ANGLE")
      ->group("Errors of the sensors");
  command
      .add_option(
          "--sway", chosen.sway,
          "Standard deviations of the body's roll and pitch and of its height over the floor, which change with "
          "the distance driven: 0.4deg,1cm")
      ->type_name("TILT,HEAVE")
      ->group("Errors of the sensors");
  command
      .add_flag("--exact", chosen.options.is_exact,
                "No noise, no rounding and no drop-outs of the laser, 2^30 ticks a turn of the crank; --noise, "
                "--resolution and --ticks still count")
      ->group("Errors of the sensors");
}

void add_simulate_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<SimulateCommand>();
  SimulateOptions& options = chosen->options;
  CLI::App* command = add_command(app, "simulate", "A log of laser and odometry, with its truth, from a scene");
  command
      ->add_option("scene", options.scene,
                   "A scene file, or the name of a sample: office-loop, corridor, "
                   "office-3f, office-7f, two-levels, three-boxes, wall, walls")
      ->required()
      ->type_name("SCENE");
  offer_words(command->get_option("scene"),
              {"office-loop", "corridor", "office-3f", "office-7f", "two-levels", "three-boxes", "wall", "walls"});
  command
      ->add_option("-o,--output", options.output,
                   "The log to write: .log, .csv, .jsonl or .mcap tell the format, any other name means CARMEN; .gz "
                   "compresses it. - sends CARMEN lines to standard output, without any file. The "
                   "truth goes beside it: NAME.truth.tum and, for a laser that "
                   "nods, NAME.linkage.yaml and NAME.elevation.csv")
      ->required()
      ->type_name("LOG");
  add_count_option(*command, "--seed", options.seed, 0, "Seed of every random number")->capture_default_str();
  command
      ->add_option(
          "--laser", options.laser,
          "Laser in place of the scene's, whose mount and height stay: sick-lms, sick-361, hokuyo-961 or lidar-360")
      ->type_name("PRESET");
  offer_words(command->get_option("--laser"), {"sick-lms", "sick-361", "hokuyo-961", "lidar-360"});
  command->add_option("--rate", options.scan_rate_hz, "Scans a second, instead of the scene's")->type_name("HZ");
  command
      ->add_option(
          "--mirror-rate", options.mirror_rate_hz,
          "Turns of the laser's mirror a second, instead of the laser's. A scan is stamped with its first beam "
          "then, and the log says when the others were measured; CARMEN cannot. Of a laser that nods only the speed "
          "counts")
      ->type_name("HZ");
  command->add_option("--trajectory", options.trajectory, "A file of waypoints, instead of the scene's")
      ->type_name("FILE");
  command->add_option("--speed", chosen->speed, "The robot's speed at most, instead of the scene's")
      ->type_name("SPEED");
  command->add_option("--turn-rate", chosen->turn_rate, "How fast the robot turns at most, instead of the scene's")
      ->type_name("SPEED");
  add_nodding_options(*command, *chosen);
  add_error_options(*command, *chosen);
  command
      ->add_option("--pace", chosen->pace,
                   "With -o -: each line comes when the robot would send it, its time going FACTOR times as fast "
                   "(default: all at once)")
      ->type_name("FACTOR")
      ->check(CLI::Range(1.0e-3, 1.0e6).description(""));
  add_force_option(*command, chosen->force);
  command->add_flag("--json", chosen->json, "Print what was done as JSON");
  command->add_flag("-q,--quiet", chosen->quiet, "Print errors only");
  command->footer(
      "The same scene, options and seed give the same bytes on every host.\n"
      "\n"
      "Examples:\n"
      "  gdtslam simulate office-loop -o office-loop.log\n"
      "  gdtslam simulate office-loop -o office-loop.mcap\n"
      "  gdtslam simulate office-loop -o - --pace 1 | gdtslam live -o drive\n"
      "  gdtslam simulate corridor -o corridor.log.gz --seed 7 --laser hokuyo-961 --rate 20\n"
      "  gdtslam simulate office-loop -o slow.mcap --laser lidar-360 --mirror-rate 5 --rate 5 --speed 0.8m/s\n"
      "  gdtslam simulate office-7f -o office-7f.log.gz --nod stop-and-scan --truth-hits\n"
      "  gdtslam simulate two-levels -o two-levels.log.gz --sway 0.4deg,1cm --elevation-error 0.5deg\n"
      "  gdtslam simulate my-scene.yaml -o my.log --trajectory my-path.yaml --json");
  command->callback([chosen, &context] { context.run = [chosen] { return run_simulate(*chosen); }; });
}

}  // namespace gdtslam
