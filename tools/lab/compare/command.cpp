// gdtslam-lab compare: compares the methods that minimise a scan's cost on the same scans and starts with proven
// solutions.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"
#include "tools/lab/matchers/output.hpp"
#include "tools/lab/matchers/run.hpp"

namespace gdtslam {
namespace {

constexpr const char* kDefaultLevels = "2cm/0.5deg,5cm/1deg,10cm/2deg,20cm/5deg,40cm/10deg,80cm/20deg";

struct CompareOptions {
  CompareJob job;  ///< the logs, their range, scans and seed; the texts below hold the rest
  std::string methods;
  std::string levels = kDefaultLevels;
  std::uint64_t starts = 1;
  std::string gap = "0.5mm";
  std::string csv;
  std::string picture;
  RecordingOptions recording;
  SettingsOptions settings;
  DeviceOptions device{.device = "cpu"};
  bool lenient = false;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == mark) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

double quantity_between(const std::string& option, const std::string& text, Unit unit, double least, double most,
                        const std::string& limits) {
  const double value = quantity_of(option, text, unit);
  if (value >= least && value <= most) return value;
  throw UsageError(fmt::format("{}: {} is out of range: {}", option, text, limits));
}

// "2cm/0.5deg,..."; "none": the prediction alone.
std::vector<StartLevel> parse_levels(const std::string& text) {
  constexpr double kMost_m = 5.0;
  constexpr double kMost_rad = 3.141592653589793;
  std::vector<StartLevel> levels;
  if (text == "none") return levels;
  for (const std::string& level : split(text, ',')) {
    const std::vector<std::string> parts = split(level, '/');
    if (parts.size() != 2) {
      throw UsageError("--starts-at: '" + level + "' is not DISTANCE/ANGLE, for example 20cm/5deg");
    }
    levels.push_back({quantity_between("--starts-at", parts[0], Unit::kMetre, 0.0, kMost_m, "0m to 5m"),
                      quantity_between("--starts-at", parts[1], Unit::kRadian, 0.0, kMost_rad, "0deg to 180deg")});
  }
  return levels;
}

CompareJob make_job(const CompareOptions& options) {
  for (const std::string& log : options.job.logs) {
    if (log == "-") throw UsageError("compare reads the log more than once: give a file, not standard input");
  }
  constexpr std::uint64_t kMostStarts = 1000;
  if (options.starts > kMostStarts) {
    throw UsageError(fmt::format("--starts: {} is more than {}", options.starts, kMostStarts));
  }
  CompareJob job = options.job;
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  job.read = read_options_of(settings.log, options.lenient);
  job.mapper = settings.mapper;
  job.methods = parse_methods("--matchers", options.methods);
  job.levels = parse_levels(options.levels);
  job.starts = static_cast<std::uint32_t>(options.starts);
  job.global.gap_m = quantity_between("--gap", options.gap, Unit::kMetre, 1e-5, 0.1, "0.01mm to 10cm");
  return job;
}

void check_files(const CompareOptions& options) {
  std::vector<std::string> inputs = options.job.logs;
  inputs.push_back(options.settings.file);
  WrittenFiles written(inputs, options.force);
  written.add("--csv", options.csv);
  written.add("--picture", options.picture);
}

std::string name_of_log(const std::string& path) { return path.substr(path.rfind('/') + 1); }

int compare(const CompareOptions& options) {
  const CompareJob job = make_job(options);
  if (!options.picture.empty()) check_drawing_file("--picture", options.picture);
  check_files(options);
  const std::unique_ptr<Backend> backend = make_backend(options.device);
  CompareOutcome outcome;
  {
    ProgressLine progress("scans", options.quiet);
    outcome = compare(
        job, *backend, [&progress](std::uint64_t scans, double share) { progress.update(scans, share); },
        [] { return interrupted(); });
  }
  if (!options.csv.empty()) write_file_atomically(options.csv, as_csv(job, outcome));
  if (!options.picture.empty()) {
    write_file_atomically(options.picture, drawing_bytes(compare_picture(job, outcome, name_of_log(job.logs.front())),
                                                         options.picture, kDensePng));
  }
  if (options.json) {
    print_result(json_text(as_json(job, outcome)));
  } else if (!options.quiet) {
    print_result(as_text(job, outcome));
  }
  return static_cast<int>(ExitCode::kDone);
}

void add_protocol_options(CLI::App& command, CompareOptions& options) {
  command
      .add_option("--matchers", options.methods,
                  fmt::format("Methods to compare, separated by commas, in this order: {} [all]",
                              fmt::join(matcher_names(), ", ")))
      ->type_name("A,B,...");
  offer_words(command.get_option("--matchers"), {matcher_names().begin(), matcher_names().end()});
  command
      .add_option("--starts-at", options.levels,
                  "Starts off the global solution, distance/angle each, besides the odometry's prediction; none")
      ->type_name("D/A,...")
      ->capture_default_str();
  add_count_option(command, "--starts", options.starts, 1, "Starts of each distance at each scan")
      ->capture_default_str();
  add_count_option(command, "--scans", options.job.scans, 1, "Scans to measure, evenly over the log")
      ->capture_default_str();
  add_count_option(command, "--seed", options.job.seed, 0, "Seed of the directions of the starts")
      ->capture_default_str();
  command.add_option("--gap", options.gap, "Gap of the mean distance that the proof of the global solution may leave")
      ->type_name("LENGTH")
      ->capture_default_str();
}

void add_output_options(CLI::App& command, CompareOptions& options) {
  add_force_option(command, options.force);
  command.add_flag("--json", options.json, "Print JSON; what depends on the machine is under \"times\"");
  command.add_option("--csv", options.csv, "Write every trial")->type_name("FILE");
  command.add_option("--picture", options.picture, "Draw the basins and the errors: .svg, .png or .pdf")
      ->type_name("FILE");
  command.add_flag("-q,--quiet", options.quiet, "Print errors only");
}

}  // namespace

void add_compare_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      add_command(app, "compare", "The methods that match a scan, on the same scans, against proven solutions");
  command->add_option("log", options->job.logs, fmt::format("{} logs, plain or gzip, one after the other", kLogFormats))
      ->required()
      ->type_name("LOG");
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines instead of failing");
  add_count_option(*command, "--skip", options->job.range.skip, 0, "Leave out the first N scans");
  add_count_option(*command, "--first", options->job.range.count, 1, "Read N scans only");
  add_protocol_options(*command, *options);
  add_recording_options(*command, options->recording);
  add_settings_options(*command, options->settings);
  add_device_options(*command, options->device, false);
  add_output_options(*command, *options);
  command->footer(
      "The log is mapped; at some of its scans, before they are matched, every method minimises the same cost on the\n"
      "map as it is then, from the same starts. Errors are distances to the global solution, which branch and bound\n"
      "proves (docs/matchers.md).\n"
      "\n"
      "Examples:\n"
      "  gdtslam-lab compare intel.clf.gz\n"
      "  gdtslam-lab compare intel.clf.gz --matchers simplex,gauss-newton --picture basins.svg --csv trials.csv\n"
      "  gdtslam-lab compare office.log --starts-at none --json");
  command->callback([options, &context] {
    context.run = [options] { return compare(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
