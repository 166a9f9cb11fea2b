#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

struct BenchOptions {
  DeviceOptions device;
  std::string filter;
  BenchLog log;  ///< without a file: no rows of a log
  RecordingOptions recording;
  SettingsOptions settings;
};

/// Adds the rows that devices have, too.
void add_rows(const BenchTarget& target) {
  add_limits(target);
  add_kernels(target);
  add_scans(target);
  add_sweeps(target);
}

BenchLog bench_log(const BenchOptions& options) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  BenchLog log = options.log;
  log.read = read_options_of(settings.log, false);
  log.mapper = settings.mapper;
  log.options = on_failure_of(options.device);
  return log;
}

void describe(const BenchTarget& target) {
  const DeviceInfo& device = target.backend.device();
  std::string text = fmt::format("{} ({}, {}), {} threads", device.name, device.kind, device.driver, device.threads);
  if (target.is_cpu()) text += fmt::format(", {}", to_string(target.backend.host_isa()));
  benchmark::AddCustomContext(target.on, text);
}

void check_log_options(const BenchOptions& options) {
  if (!options.log.file.empty()) return;
  const bool is_configured = !(options.settings.file.empty() && options.settings.sets.empty());
  if (!is_configured && !options.recording.are_stated() && options.log.loops) return;
  throw UsageError("bench: --config, --set, --no-loops, --topic, --odom, --crank and --mount are for a --log");
}

/// Passes google-benchmark its own options. Throws UsageError for others.
void give_options(const std::string& filter, const std::vector<std::string>& extras) {
  static std::string program = "gdtslam-lab bench";  // google-benchmark keeps a pointer to it
  std::vector<std::string> words;
  if (!filter.empty()) words.push_back("--benchmark_filter=" + filter);
  words.insert(words.end(), extras.begin(), extras.end());
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (count > 1) throw UsageError(fmt::format("bench: unexpected argument '{}'", arguments[1]));
}

int bench(const BenchOptions& options, const std::vector<std::string>& extras) {
  check_log_options(options);
  give_options(options.filter, extras);
  const std::unique_ptr<Backend> cpu = make_cpu(options.device);
  const BenchTarget cpu_target{*cpu, "cpu"};
  const std::unique_ptr<VulkanBackend> device = make_vulkan(options.device, {.time_submissions = true});
  benchmark::AddCustomContext("gdtslam", GDTSLAM_VERSION);
  describe(cpu_target);
  add_rows(cpu_target);
  if (!options.log.file.empty()) add_live(cpu_target, bench_log(options));
  if (device) {
    const BenchTarget target{*device, fmt::format("vulkan:{}", device->vulkan_device().index)};
    describe(target);
    add_rows(target);
    if (!options.log.file.empty()) {
      BenchLog log = bench_log(options);
      log.mapper.match.matcher = MatcherKind::kExhaustive;  // windows are the larger part of a device's work
      add_work(target, log);
    }
  }
  if (benchmark::RunSpecifiedBenchmarks() == 0) {
    throw UsageError("bench: no row's name matches '" + options.filter + "'");
  }
  std::cout.flush();
  if (!std::cout) throw FileError("standard output", "cannot be written");
  if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; the rows before it are printed");
  rethrow_bench_error();
  return static_cast<int>(ExitCode::kDone);
}

void add_log_options(CLI::App& command, BenchOptions& options) {
  command.add_option("--log", options.log.file, "Log whose scans are matched: rows 'live' and, with a device, 'work'")
      ->type_name("LOG");
  add_recording_options(command, options.recording);
  add_settings_options(command, options.settings);
  command
      .add_option("--speed", options.log.speed,
                  "Times as fast as their stamps say that the scans of 'live' come; 0 for as fast as they are done")
      ->type_name("N")
      ->check(CLI::Range(0.0, 1.0e6))
      ->capture_default_str();
  command.add_flag("!--no-loops", options.log.loops, "Match each scan of 'live' with one map of all that was seen");
}

}  // namespace

void add_bench_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = add_command(app, "bench", "How fast the kernels and whole steps are here, by google-benchmark");
  command
      ->add_option(
          "filter", options->filter,
          "Only rows whose name DEVICE/GROUP/NAME/VARIANT this regular expression finds; the groups are limit, "
          "kernel, scan, sweep, live and work")
      ->type_name("REGEX");
  add_log_options(*command, *options);
  add_device_options(*command, options->device, false);
  command->allow_extras();
  command->footer(
      "google-benchmark's options follow, all of them --benchmark_NAME=VALUE: --benchmark_repetitions=9,\n"
      "--benchmark_min_time=0.1, --benchmark_format=json, --benchmark_out=FILE, --benchmark_list_tests. Its "
      "compare.py\n"
      "compares two such files. With a device, the CPU is measured too.\n"
      "\n"
      "Examples:\n  gdtslam-lab bench kernel\n  gdtslam-lab bench scan --device vulkan --benchmark_format=json\n"
      "  gdtslam-lab bench pose_cost --isa avx2\n  gdtslam-lab bench live --log intel.clf.gz --speed 0 --no-loops\n"
      "  gdtslam-lab bench work --device vulkan --log intel.clf.gz\n"
      "  gdtslam-lab bench kernel --benchmark_repetitions=9 --benchmark_out=before.json");
  command->callback([options, command, &context] {
    context.run = [options, extras = command->remaining()] { return bench(*options, extras); };
  });
}

}  // namespace gdtslam
