// gdtslam doctor: content and faults of a log; doubtful parts of a map (after.cpp).
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <optional>
#include <string>

#include "engine/io/json_file.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "engine/runs/streams/scan_motion.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/runs/settings.hpp"
#include "tools/gdtslam/doctor/doctor.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

Findings examine_log(const DoctorOptions& options) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  ReadOptions read = read_options_of(settings.log, true);
  read.survey = true;
  Findings found;
  LogChecker checker(found.bounds, settings.mapper.scan);
  const std::unique_ptr<DescribedLog> reader = open_described_log(options.log, read);
  ProgressLine progress("records", false);
  std::uint64_t records = 0;
  while (const std::optional<LogRecord> record = reader->next()) {
    checker.add(*record);
    progress.update(++records, reader->progress());
    if (interrupted()) break;
  }
  progress.clear();
  found.check = checker.finish(reader->warnings());
  found.contents = reader->contents();
  const NoReturns& constants = found.check.no_returns;
  if (const auto value = constants.taken(settings.mapper.scan); value && settings.log.max_range_m == 0.0) {
    found.faults.push_back(no_return_finding(*value, constants.beams));
    read.max_range_m = value->range_m;
  }
  const bool is_measured = settings.log.odometry_stamps == OdometryStamps::kMeasured &&
                           !found.check.nod.has_records();  // the same rule as in map
  if (is_measured && !interrupted() && found.check.obstacle().empty()) {
    const MotionLook look =
        look_at_motion_by_scans(options.log, read, {}, settings.mapper, [] { return interrupted(); });
    found.delay = estimate_delay(to_headings(look.faultless()));
    found.faults.insert(found.faults.end(), look.faults.begin(), look.faults.end());
  }
  found.commands = map_commands(options, found.contents, found.check, found.faults);
  return found;
}

int doctor(const DoctorOptions& options) {
  const Findings found = examine_log(options);
  print_result(options.json ? json_text(findings_json(found, options.log)) : findings_text(found, options.log));
  if (interrupted())
    throw Error(ExitCode::kInterrupted, "interrupted; the figures are those of the part that was read");
  const std::string obstacle = found.check.obstacle();
  if (!obstacle.empty()) throw InputError({log_name(options.log), 0}, "cannot be mapped: " + obstacle);
  return static_cast<int>(ExitCode::kDone);
}

int run_doctor(const DoctorOptions& options) {
  if (!options.after.empty()) {
    if (options.recording.are_stated())
      throw UsageError("--topic, --odom, --crank and --mount are for a LOG, not --after");
    if (!options.settings.file.empty() || !options.settings.sets.empty())
      throw UsageError("--config and --set are for a LOG, not --after");
    return doctor_after(options);
  }
  if (options.devices) return doctor_of_devices(options.json);
  if (options.log.empty()) throw UsageError("nothing to look at: give a LOG, --after RUN, or --devices");
  return doctor(options);
}

}  // namespace

void add_doctor_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command =
      add_command(app, "doctor", "What is wrong with a log, or doubtful in a map; what can compute here");
  CLI::Option* const log =
      command->add_option("log", options->log, fmt::format("{} log, plain or gzip; - is standard input", kLogFormats));
  log->type_name("LOG");
  add_recording_options(*command, options->recording);
  add_settings_options(*command, options->settings);
  CLI::Option* const after = command->add_option(
      "--after", options->after, "Folder of a run, in place of a log: what is doubtful in its map, and where");
  after->type_name("RUN")->excludes(log);
  command
      ->add_flag("--devices", options->devices,
                 "In place of a log: what can compute here, processor, instruction sets and GPUs")
      ->excludes(log)
      ->excludes(after);
  command
      ->add_option("--picture", options->picture,
                   "With --after: draw loops, uncertainty and what is doubtful, numbered: .svg, .png or .pdf")
      ->type_name("FILE")
      ->needs(after);
  add_force_option(*command, options->force);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer(
      "What it holds (topics, frames, clocks, or kinds of lines), what of it 'map' uses and why, and the line to "
      "type.\n"
      "Counts, rates, gaps, time jumps, impossible steps of the odometry, the value that means no return, the laser\n"
      "on the robot, the beams and the length of the path. Exit 65 when the log cannot be mapped.\n"
      "After mapping: stretches whose position is uncertain, loops that were found and are not believed, wheels that\n"
      "are off, scans that were refused, each with a line of advice; exit 0 whatever is doubtful.\n"
      "\n"
      "Examples:\n"
      "  gdtslam doctor intel.clf.gz\n"
      "  gdtslam doctor drive.log --json | jq .impossible_steps.count\n"
      "  gdtslam doctor --after out --picture doubtful.png\n"
      "  gdtslam doctor --devices");
  command->callback([options, &context] { context.run = [options] { return run_doctor(*options); }; });
}

}  // namespace gdtslam
