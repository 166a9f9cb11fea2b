// gdtslam doctor: what is in a log, and what is wrong with it; what is doubtful in a map (after.cpp).
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "contents.hpp"
#include "doctor.hpp"
#include "engine/drawing/plots/log_picture.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "engine/runs/streams/log_timeline.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "engine/runs/streams/scan_motion.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "findings.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/runs/settings.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

/// The last part of a path, without a slash behind it.
std::string title_of(const std::string& log) {
  const std::filesystem::path path(log_name(log));
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// Along the stamps or, where they are all the same, along the scans.
struct Timelines {
  explicit Timelines(const StepBounds& bounds) : by_time(bounds), by_scans(bounds, LogTimeline::Along::kScans) {}
  void add(const LogRecord& record) {
    by_time.add(record);
    has_time = has_time || by_time.has_length();
    if (!has_time) by_scans.add(record);
  }
  LogTimeline by_time;
  LogTimeline by_scans;
  bool has_time = false;
};

void draw(const Timelines& timelines, const LogCheck& check, const DoctorOptions& options) {
  if (check.scans == 0) return;
  const bool has_time = timelines.has_time || check.scans == 1;
  const LogTimeline& timeline = has_time ? timelines.by_time : timelines.by_scans;
  const LogPicture picture = timeline.picture(check, title_of(options.log));
  const Canvas drawing = log_picture(picture, size_of_log_picture(picture));
  write_file_atomically(options.picture, drawing_bytes(drawing, options.picture));
}

Findings findings_of(const DoctorOptions& options) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  ReadOptions read = read_options_of(settings.log, true);
  read.survey = true;
  Findings found;
  LogChecker checker(found.bounds, settings.mapper.scan);
  Timelines timelines(found.bounds);
  const std::unique_ptr<DescribedLog> reader = open_described_log(options.log, read);
  ProgressLine progress("records", false);
  std::uint64_t records = 0;
  while (const std::optional<LogRecord> record = reader->next()) {
    checker.add(*record);
    if (!options.picture.empty()) timelines.add(*record);
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
  const bool is_measured =
      settings.log.odometry_stamps == OdometryStamps::kMeasured && !found.check.nod.has_records();  // as in map
  if (is_measured && !interrupted() && found.check.obstacle().empty()) {
    const MotionLook look =
        look_at_motion_by_scans(options.log, read, {}, settings.mapper, [] { return interrupted(); });
    found.delay = delay_of(headings_of(look.faultless()));
    found.faults.insert(found.faults.end(), look.faults.begin(), look.faults.end());
  }
  found.commands = map_commands(options, found.contents, found.check, found.faults);
  if (!options.picture.empty()) draw(timelines, found.check, options);
  return found;
}

int doctor(const DoctorOptions& options) {
  if (!options.picture.empty()) {
    check_drawing_file("--picture", options.picture);
    WrittenFiles({options.log, options.settings.file}).add("--picture", options.picture);
  }
  const Findings found = findings_of(options);
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
  if (options.log.empty()) throw UsageError("nothing to look at: give a LOG, or --after RUN");
  return doctor(options);
}

}  // namespace

void add_doctor_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = add_command(app, "doctor", "What is wrong with a log, or doubtful in a map");
  CLI::Option* const log =
      command->add_option("log", options->log, fmt::format("{} log, plain or gzip; - is standard input", kLogFormats));
  log->type_name("LOG");
  add_recording_options(*command, options->recording);
  add_settings_options(*command, options->settings);
  CLI::Option* const after = command->add_option(
      "--after", options->after, "Folder of a run, in place of a log: what is doubtful in its map, and where");
  after->type_name("RUN")->excludes(log);
  command
      ->add_option("--picture", options->picture,
                   "Draw scan rate, motion and ranges of the log over time; with --after loops, uncertainty and what\n"
                   "is doubtful, numbered: .svg, .png or .pdf")
      ->type_name("FILE");
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
      "  gdtslam doctor drive.mcap --picture drive.png\n"
      "  gdtslam doctor drive.log --json | jq .impossible_steps.count\n"
      "  gdtslam doctor --after out --picture doubtful.png");
  command->callback([options, &context] { context.run = [options] { return run_doctor(*options); }; });
}

}  // namespace gdtslam
