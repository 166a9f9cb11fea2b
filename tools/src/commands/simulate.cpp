// gdtslam simulate: a log with ground truth from a scene.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "asset_folder.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/json_file.hpp"
#include "interrupt.hpp"
#include "progress.hpp"
#include "simulate_run.hpp"
#include "whole_number.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct SimulateCommand {
  SimulateOptions options;
  bool json = false;
  bool quiet = false;
};

std::string summary_of(const SimulateResult& result) {
  const double returns =
      result.beams > 0 ? static_cast<double>(result.returns) / static_cast<double>(result.beams) : 0.0;
  return fmt::format(
      "{} scans, {} odometry lines; {:.1f} m in {:.1f} s; {:.2f} % of the beams returned\n"
      "{} triangles; nearest obstacle {:.2f} m from the robot's centre; simulated in {:.2f} s\n"
      "log {}\ntruth {}\n",
      result.scans, result.odometry_lines, result.path_m, result.duration_s, 100.0 * returns, result.triangles,
      result.clearance_m, result.wall_s, result.log_file, result.truth_file);
}

Json report_of(const SimulateResult& result, std::uint64_t seed) {
  return {{"scene", result.scene_file},
          {"log", result.log_file},
          {"truth", result.truth_file},
          {"seed", seed},
          {"scans", result.scans},
          {"odometry_lines", result.odometry_lines},
          {"beams", result.beams},
          {"returns", result.returns},
          {"triangles", result.triangles},
          {"log_bytes", result.log_bytes},
          {"duration_s", result.duration_s},
          {"path_m", result.path_m},
          {"clearance_m", result.clearance_m},
          {"wall_s", result.wall_s},
          {"interrupted", result.interrupted}};
}

int run_simulate(const SimulateCommand& command) {
  SimulateOptions options = command.options;
  ProgressLine progress("scans", command.quiet);
  options.scene_folders = asset_folders("scenes");
  options.progress = [&progress](std::uint64_t scans, double share) { progress.update(scans, share); };
  options.stop = [] { return interrupted(); };
  const SimulateResult result = simulate(options);
  progress.clear();
  if (command.json) {
    print_result(json_text(report_of(result, options.seed)));
  } else if (!command.quiet) {
    print_result(summary_of(result));
  }
  if (!result.interrupted) {
    return static_cast<int>(ExitCode::kDone);
  }
  print_remark(fmt::format("interrupted after {} scans, which are in {}", result.scans, result.log_file));
  return static_cast<int>(ExitCode::kInterrupted);
}

}  // namespace

void add_simulate_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<SimulateCommand>();
  SimulateOptions& options = chosen->options;
  CLI::App* command = app.add_subcommand("simulate", "A log of laser and odometry, with its truth, from a scene");
  command->add_option("scene", options.scene, "A scene file, or the name of a sample: office-loop, corridor")
      ->required()
      ->type_name("SCENE");
  command
      ->add_option("-o,--output", options.output,
                   "The log to write; .gz compresses it. The truth goes beside it, as NAME.truth.tum")
      ->required()
      ->type_name("LOG");
  command->add_option("--seed", options.seed, "Seed of every random number")
      ->type_name("N")
      ->check(whole_number_from(0))
      ->capture_default_str();
  command
      ->add_option("--laser", options.laser,
                   "Instead of the scene's laser: sick-lms, sick-361 or hokuyo-961 (mount and height stay)")
      ->type_name("PRESET");
  command->add_option("--rate", options.scan_rate_hz, "Scans a second, instead of the scene's")->type_name("HZ");
  command->add_option("--trajectory", options.trajectory, "A file of waypoints, instead of the scene's")
      ->type_name("FILE");
  command->add_flag("--json", chosen->json, "Print what was done as JSON");
  command->add_flag("-q,--quiet", chosen->quiet, "Print errors only");
  command->footer(
      "The same scene, options and seed give the same bytes on every host.\n"
      "\n"
      "Examples:\n"
      "  gdtslam simulate office-loop -o office-loop.log\n"
      "  gdtslam simulate corridor -o corridor.log.gz --seed 7 --laser hokuyo-961 --rate 20\n"
      "  gdtslam simulate my-scene.yaml -o my.log --trajectory my-path.yaml --json");
  command->callback([chosen, &context] { context.run = [chosen] { return run_simulate(*chosen); }; });
}

}  // namespace gdtslam
