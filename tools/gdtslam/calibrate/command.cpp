// gdtslam calibrate: a linkage from ranges to surfaces of known kinds, with each parameter's uncertainty.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibrate.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

struct CalibrateCommand {
  CalibrateJob job;
  RecordingOptions recording;
  bool lenient = false;
  std::string start = std::string(calib::kDefaultLinkage);
  std::string output;
  std::string picture;
  std::string up_to = "60deg";
  std::string sector;
  std::string sigma;
  bool no_prior = false;
  bool is_self = false;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

double angle_within(const std::string& option, const std::string& text, double least_deg, double most_deg) {
  const double value_rad = quantity_of(option, text, Unit::kRadian);
  const double value_deg = deg_from_rad(value_rad);
  if (value_deg >= least_deg - 1e-9 && value_deg <= most_deg + 1e-9) return value_rad;
  throw UsageError(fmt::format("{}: {} is not between {:g} and {:g} deg", option, text, least_deg, most_deg));
}

ReadOptions make_read_options(const CalibrateCommand& command) {
  LogConfig log;
  state_recording(command.recording, log);
  return read_options_of(log, command.lenient);
}

CalibrateJob make_job(const CalibrateCommand& command) {
  CalibrateJob job = command.job;
  job.read = make_read_options(command);
  job.start = resolve_linkage(command.start);
  job.options.max_elevation_rad = angle_within("--up-to", command.up_to, 5.0, 89.0);
  if (!command.sector.empty()) job.sector_rad = angle_within("--sector", command.sector, 0.0, 360.0);
  if (!command.sigma.empty()) {
    job.sigma_m = quantity_of("--sigma", command.sigma, Unit::kMetre);
    if (!(job.sigma_m > 0.0 && job.sigma_m < 1.0))
      throw UsageError("--sigma: " + command.sigma + " is not above 0 and below 1 m");
  }
  if (job.sector_rad <= 0.0 && (job.headings_free || job.options.free_sensor_angles)) {
    throw UsageError(fmt::format("{} needs beams of several bearings: add --sector, as in --sector 200deg",
                                 job.headings_free ? "--free-headings" : "--free-angles"));
  }
  if (command.no_prior) job.options = job.options.without_priors();
  return job;
}

// Sigmas in the linkage file: those of parameters determined by data or priors. They are valid only if the model fits,
// so a file written with --force has none.
template <typename Outcome>
std::vector<ParameterSigma> stated_sigmas(const Outcome& outcome) {
  std::vector<ParameterSigma> list;
  if (!outcome.distrust.empty()) return list;
  for (const calib::CalibratedParameter& parameter : outcome.result.parameters) {
    if (std::isfinite(parameter.sigma)) list.push_back({parameter.name, parameter.sigma});
  }
  return list;
}

void refuse_distrusted(const CalibrateCommand& command, const std::string& distrust, const std::string& advice) {
  if (distrust.empty()) return;
  if (!command.force) {
    throw Error(ExitCode::kFailed,
                fmt::format("not to be trusted, so nothing is written: {}; {}, or --force", distrust, advice));
  }
  print_remark("warning: not to be trusted, written by --force and without uncertainties: " + distrust);
}

// Runs the job with a progress line that counts in `unit`.
template <typename Run>
auto with_progress(const CalibrateCommand& command, const char* unit, const Run& run) {
  ProgressLine progress(unit, command.quiet);
  std::uint64_t done = 0;
  auto outcome = run([&](double share) { progress.update(++done, share); }, [] { return interrupted(); });
  progress.clear();
  if (!command.quiet) print_warnings(outcome.warnings);
  return outcome;
}

// Writes both linkage and figure or neither, and prints the result.
template <typename Outcome>
int finish(const CalibrateCommand& command, const Outcome& outcome, const std::optional<Canvas>& figure = {}) {
  AtomicFileSet files;
  if (figure) files.add(command.picture).write(drawing_bytes(*figure, command.picture, kDensePng));
  files.add(command.output).write(linkage_text(outcome.result.model, stated_sigmas(outcome)));
  files.commit();
  if (command.json) {
    print_result(json_text(as_json(outcome)));
  } else if (!command.quiet) {
    print_result(as_text(outcome) + "\nlinkage " + command.output + "\n");
  }
  return static_cast<int>(ExitCode::kDone);
}

void check_files(const CalibrateCommand& command) {
  if (!command.picture.empty()) check_drawing_file("--picture", command.picture);
  std::vector<std::string> inputs = command.job.logs;
  inputs.push_back(linkage_file_of(command.start));
  WrittenFiles written(inputs, command.force);
  written.add("--output", command.output);
  written.add("--picture", command.picture);
}

int run_calibrate(const CalibrateCommand& command) {
  check_files(command);
  const CalibrateJob job = make_job(command);
  const CalibrateOutcome outcome = with_progress(command, "records", [&job](const auto& progress, const auto& stop) {
    return run_calibration(job, progress, stop);
  });
  refuse_distrusted(command, outcome.distrust,
                    "another --start or other --surfaces (where they are, what stands before them)");
  if (command.picture.empty()) return finish(command, outcome);
  return finish(command, outcome, calibration_figure(outcome));
}

int run_self(const CalibrateCommand& command) {
  check_files(command);
  SelfCalibrateJob job{.logs = command.job.logs,
                       .start = resolve_linkage(command.start),
                       .read = make_read_options(command),
                       .options = {}};
  job.options.priors.free_lever = command.job.options.free_lever;
  job.options.priors.free_sensor_angles = command.job.options.free_sensor_angles;
  const SelfCalibrateOutcome outcome = with_progress(command, "steps", [&job](const auto& progress, const auto& stop) {
    return run_self_calibration(job, progress, stop);
  });
  refuse_distrusted(command, outcome.distrust, "a better --start");
  return finish(command, outcome);
}

void add_data_options(CLI::App& command, CalibrateCommand& chosen) {
  command
      .add_option("--surfaces", chosen.job.surfaces,
                  "What stands around the scanner: wall, floor, ceiling, each with =DISTANCE from the nodding axis and "
                  "(walls) @HEADING where known")
      ->type_name("LIST")
      ->capture_default_str();
  command.add_flag("--known-distances", chosen.job.distances_known,
                   "The distances given (each with =DISTANCE) are exact");
  command.add_flag("--free-headings", chosen.job.headings_free, "Estimate the walls' headings too (needs --sector)");
  command.add_option("--sector", chosen.sector, "Use the beams of a sector around the forward one [the forward beam]")
      ->type_name("ANGLE");
  command.add_option("--up-to", chosen.up_to, "Use ranges up to this elevation")
      ->type_name("ANGLE")
      ->capture_default_str();
  command.add_option("--sigma", chosen.sigma, "Standard deviation of one range [from the scatter]")
      ->type_name("LENGTH");
  add_recording_options(command, chosen.recording);
  command.add_flag("--lenient", chosen.lenient, "Count and skip malformed lines");
}

}  // namespace

void add_calibrate_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<CalibrateCommand>();
  CLI::App* command =
      add_command(app, "calibrate", "A nodding mount's linkage from ranges to a wall, with uncertainty");
  command->add_option("logs", chosen->job.logs, "Logs of the standing robot: scans and ENCODER")
      ->required()
      ->type_name("LOG");
  command->add_option("-o,--output", chosen->output, "The linkage file to write, for map --linkage")
      ->required()
      ->type_name("FILE");
  command->add_option("--start", chosen->start, "What is believed of the linkage: a preset or a linkage file")
      ->type_name("LINKAGE")
      ->capture_default_str();
  add_data_options(*command, *chosen);
  command->add_flag("--free-lever", chosen->job.options.free_lever, "Estimate the sensor's place off the axis too");
  command->add_flag("--free-angles", chosen->job.options.free_sensor_angles,
                    "Estimate the sensor's roll and yaw too (needs --sector or --self)");
  command->add_flag("--search-zero", chosen->job.options.search_zero,
                    "The encoder's zero is not known at all: try the whole turn");
  command->add_flag("--no-prior", chosen->no_prior,
                    "Let the data alone decide; what they do not tell stays at the start");
  command
      ->add_option("--picture,--svg", chosen->picture,
                   "Draw the ranges before and after (figure A): .svg, .png or .pdf")
      ->type_name("FILE");
  CLI::Option* const self =
      command->add_flag("--self", chosen->is_self,
                        "From a mapping log: what the up and the down strokes see must agree; no surface is given");
  for (const char* name : {"--surfaces", "--known-distances", "--free-headings", "--sector", "--up-to", "--sigma",
                           "--search-zero", "--no-prior", "--picture"}) {
    self->excludes(command->get_option(name));
  }
  command->add_flag("--force", chosen->force,
                    "Replace outputs that exist, and write the linkage if it is not to be trusted, without sigmas");
  command->add_flag("--json", chosen->json, "Print JSON");
  command->add_flag("-q,--quiet", chosen->quiet, "Print errors only");
  command->footer(
      "The crank may stop or turn; ranges from the same place of it are averaged. docs/howto/calibrate.md says how to\n"
      "record a log, docs/calibration.md what it can tell.\n"
      "\n"
      "Examples:\n"
      "  gdtslam calibrate wall.log -o linkage.yaml\n"
      "  gdtslam calibrate wall.log -o linkage.yaml --start mine.yaml --surfaces wall=2m,ceiling=2.2m --free-lever\n"
      "  gdtslam calibrate wall.log -o linkage.yaml --picture figure-a.svg --json\n"
      "  gdtslam calibrate office.log -o better.yaml --start linkage.yaml --self");
  command->callback([chosen, &context] {
    context.run = [chosen] { return chosen->is_self ? run_self(*chosen) : run_calibrate(*chosen); };
  });
}

}  // namespace gdtslam
