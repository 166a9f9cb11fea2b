// gdtslam bench: how fast the kernels are here, CPU and device side by side, beside a plain copy and beside OpenCV
// where the build has it.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "against.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "live.hpp"
#include "queue_work.hpp"
#include "report.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kLargestSize = 8192;

struct BenchOptions {
  DeviceOptions device;
  std::string filter;
  std::uint32_t size = 1024;
  TimingOptions timing;
  std::string log;  ///< none: the sample
  RecordingOptions recording;
  SettingsOptions settings;
  CertifiedBenchJob certified{};
  LiveBenchJob live{};
  LogBenchJob logs{};
  std::string against;      ///< of an earlier run, its JSON; empty: none
  double fail_below = 0.0;  ///< 0: never
  bool json = false;
  bool flood_errors = false;
  [[nodiscard]] bool is_certified() const { return filter == "certified"; }
  [[nodiscard]] bool is_live() const { return filter == "live"; }
  [[nodiscard]] bool is_logs() const { return filter == "logs"; }
  [[nodiscard]] bool is_work() const { return filter == "work"; }
  /// Whether a log is mapped for it.
  [[nodiscard]] bool maps() const { return is_certified() || is_live() || is_work(); }
};

int print_flood_errors(Backend& backend, const BenchOptions& options) {
  Json list = Json::array();
  std::string text =
      "| grid | seeds | variant | passes | wrong cells | share | largest error |\n|---|---|---|---|---|---|---|\n";
  for (std::uint32_t size = 512; size <= options.size; size *= 2) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
    for (const FloodErrorRow& row : flood_errors(backend, size)) {
      text += fmt::format("| {}² | {} | {} | {} | {} | {:.4f} % | {:.3f} cells |\n", row.size, row.seeds, row.variant,
                          row.passes, row.wrong_cells, 100.0 * row.wrong_share, row.largest_cells);
      list.push_back({{"size", row.size},
                      {"seeds", row.seeds},
                      {"variant", row.variant},
                      {"passes", row.passes},
                      {"wrong_cells", row.wrong_cells},
                      {"wrong_share", row.wrong_share},
                      {"largest_cells", row.largest_cells}});
    }
  }
  const Json report{
      {"version", GDTSLAM_VERSION}, {"device", device_json(backend.device())}, {"jump_flood_errors", list}};
  print_result(options.json ? json_text(report) : text);
  return static_cast<int>(ExitCode::kDone);
}

bool wants(const BenchOptions& options, std::string_view group) { return group.find(options.filter) != group.npos; }

/// The CPU's limits before the other rows, and the rows held against them.
void add_limits(Backend& backend, const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::vector<BenchRow> limits = bench_limits(backend, options.timing);
  compare_with_limits(rows, limits);
  rows.insert(rows.begin(), std::make_move_iterator(limits.begin()), std::make_move_iterator(limits.end()));
}

Measured measure_all(Backend& backend, std::string name, const BenchOptions& options) {
  Measured measured{std::move(name), backend.device(), {}, basis_of(backend), {}};
  if (measured.device.kind == "cpu") measured.isa = backend.host_isa();
  measured.rows = bench_kernels(backend, options.filter, options.timing);
  const auto add = [&measured](std::vector<BenchRow> rows) {
    for (BenchRow& row : rows) measured.rows.push_back(std::move(row));
  };
  if (wants(options, "transform")) add(bench_transforms(backend, options.size, options.timing));
  if (wants(options, "scan")) add(bench_scans(backend, options.timing));
  if (wants(options, "sweep")) add(bench_sweeps(backend, options.timing));
  if (measured.device.kind == "cpu" && wants(options, "clouds")) add(bench_clouds(options.timing));
#ifdef GDTSLAM_HAS_VIEWER
  if (measured.device.kind == "cpu" && wants(options, "viewer")) add(bench_viewer(options.timing));
#endif
  if (measured.device.kind == "cpu" && (wants(options, "limit") || !measured.rows.empty())) {
    add_limits(backend, options, measured.rows);
  }
  if (measured.rows.empty()) throw UsageError("bench: no kernel's name contains '" + options.filter + "'");
  return measured;
}

// Before anything is measured, as that would be lost.
void check_size(const VulkanBackend& device, const BenchOptions& options) {
  const std::size_t bytes = device.device().max_buffer_bytes;
  const std::uint32_t largest = largest_transform(bytes, options.size);
  if (largest == options.size || !(options.flood_errors || wants(options, "transform"))) return;
  throw UsageError(
      fmt::format("bench: --size {} is too large for vulkan:{}, whose buffers have {} bytes at most; give {} or less",
                  options.size, device.vulkan_device().index, bytes, largest));
}

ReadOptions read_of(const BenchOptions& options, LogConfig config) {
  state_recording(options.recording, config);
  return read_options_of(config, false);
}

int print_certified(Backend& cpu, const BenchOptions& options) {
  const Settings settings = load_settings(options.settings);
  CertifiedBenchJob job = options.certified;
  job.log = options.log.empty() ? sample_log_file() : options.log;
  job.read = read_of(options, settings.log);
  job.mapper = settings.mapper;
  print_result(bench_certified(
      job, cpu, [] { return interrupted(); }, options.json));
  return static_cast<int>(ExitCode::kDone);
}

int print_live(Backend& cpu, const BenchOptions& options) {
  const Settings settings = load_settings(options.settings);
  LiveBenchJob job = options.live;
  job.log = options.log.empty() ? sample_log_file() : options.log;
  job.read = read_of(options, settings.log);
  job.mapper = settings.mapper;
  job.options = on_failure_of(options.device);
  print_result(bench_live(
      job, cpu, [] { return interrupted(); }, options.json));
  return static_cast<int>(ExitCode::kDone);
}

// Only the matcher `exhaustive` works on a device.
int print_work(const BenchOptions& options) {
  const std::unique_ptr<VulkanBackend> device = make_vulkan(options.device, {.time_submissions = true});
  if (!device) throw UsageError("bench: 'gdtslam bench work' counts what a device does: name one by --device");
  const Settings settings = load_settings(options.settings);
  WorkBenchJob job{options.log.empty() ? sample_log_file() : options.log, read_of(options, settings.log),
                   settings.mapper};
  job.mapper.match.matcher = MatcherKind::kExhaustive;
  print_result(bench_work(
      job, *device, [] { return interrupted(); }, options.json));
  return static_cast<int>(ExitCode::kDone);
}

int print_logs(const Backend& cpu, const BenchOptions& options) {
  LogBenchJob job = options.logs;
  job.timing = options.timing;
  job.timing.longest_s = 0.5;  // of nine formats, each with what stands beside it
  print_result(bench_logs(
      job, cpu, [] { return interrupted(); }, options.json));
  return static_cast<int>(ExitCode::kDone);
}

// What belongs to a log that is mapped.
void check_log_options(const BenchOptions& options) {
  if (!options.maps() && !options.log.empty()) {
    throw UsageError("bench: --log is for 'gdtslam bench certified', 'live' and 'work'");
  }
  if (!options.maps() && !(options.settings.file.empty() && options.settings.sets.empty())) {
    throw UsageError("bench: --config and --set are for 'gdtslam bench certified', 'live' and 'work'");
  }
  if (!options.is_live() && !options.live.loops) throw UsageError("bench: --no-loops is for 'gdtslam bench live'");
  if (options.log.empty() && options.recording.are_stated()) {
    throw UsageError("bench: --topic, --odom, --crank and --mount are for a --log");
  }
}

void check_against(const BenchOptions& options) {
  if (options.fail_below > 0.0 && options.against.empty()) throw UsageError("bench: --fail-below needs --against FILE");
  const bool has_rows = !options.maps() && !options.is_logs() && !options.flood_errors;
  if (!options.against.empty() && !has_rows) {
    throw UsageError(
        "bench: --against compares rows of kernels and the like, not certified, live, work, logs, --flood-errors");
  }
}

int bench(const BenchOptions& options) {
  check_log_options(options);
  check_against(options);
  std::optional<EarlierBench> before;
  if (!options.against.empty()) before = read_bench(options.against);
  if (options.is_work()) return print_work(options);
  const std::unique_ptr<Backend> cpu = make_cpu(options.device);
  if (options.is_live()) return print_live(*cpu, options);
  if (options.is_certified()) return print_certified(*cpu, options);
  if (options.is_logs()) return print_logs(*cpu, options);
  const std::unique_ptr<VulkanBackend> device = make_vulkan(options.device, {.time_submissions = true});
  if (device) check_size(*device, options);
  if (options.flood_errors) return print_flood_errors(device ? *device : *cpu, options);
  std::vector<Measured> all{measure_all(*cpu, "cpu", options)};
  if (device) {
    all.push_back(measure_all(*device, fmt::format("vulkan:{}", device->vulkan_device().index), options));
  }
  const std::string text = device ? pair_report(all.front(), all.back()) : cpu_report(all.front());
  if (!before) {
    print_result(options.json ? json_text(bench_json(all)) : text);
    return static_cast<int>(ExitCode::kDone);
  }
  for (const std::string& line : other_devices(*before, all)) print_remark(line);
  const Against against = compare_with(*before, all);
  Json json = bench_json(all);
  json["against"] = against_json(against);
  print_result(options.json ? json_text(json) : text + against_text(against));
  require_at_least(against, options.fail_below);
  return static_cast<int>(ExitCode::kDone);
}

void add_log_options(CLI::App& command, BenchOptions& options) {
  command
      .add_option("--log", options.log, "Log that certified, live and work map (default: the sample that comes along)")
      ->type_name("LOG");
  add_recording_options(command, options.recording);
  add_settings_options(command, options.settings);
  command.add_option("--scans", options.certified.scans, "Scans that certified looks for, evenly over the log")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  add_quantity_option(
      command, "--lattice", options.certified.lattice_s, Unit::kSecond, {0.0, 1.0e6},
      "CPU time of certified for the lattice beside it in each window, one search at least; 0 leaves it out")
      ->default_str(format_quantity(options.certified.lattice_s, Unit::kSecond));
  command
      .add_option("--speed", options.live.speed,
                  "Times as fast as their stamps say that the scans of live come; 0 for as fast as they are done")
      ->type_name("N")
      ->check(CLI::Range(0.0, 1.0e6))
      ->capture_default_str();
  command.add_flag("!--no-loops", options.live.loops, "Match each scan of live with one map of all that was seen");
}

void add_comparison_options(CLI::App& command, BenchOptions& options) {
  command
      .add_option(
          "--against", options.against,
          "What an earlier run printed with --json: each row says how many times as fast it is now, with its interval")
      ->type_name("FILE");
  command
      .add_option("--fail-below", options.fail_below,
                  "Exit 1 where a row's whole interval lies below this many times the speed of --against")
      ->type_name("R")
      ->check(CLI::Range(0.0, 1.0e3));
}

}  // namespace

void add_bench_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command =
      add_command(app, "bench", "How fast the kernels are here, on the CPU and on a device, beside a plain copy");
  command
      ->add_option("filter", options->filter,
                   "Only kernels whose name contains this; 'transform': whole transforms; 'scan': whole scans; "
                   "'sweep': whole sweeps; 'clouds': files and thinning; 'viewer': frames of clouds and of a linkage; "
                   "'certified': certified matching in the merged map of a log, on the CPU; 'live': each scan of a log "
                   "that is mapped, as it comes, on the CPU; 'work': what mapping a log by the matcher exhaustive asks "
                   "of a device; "
                   "'logs': logs of every format read")
      ->type_name("NAME");
  offer_words(command->get_option("filter"),
              {"transform", "scan", "sweep", "clouds", "viewer", "certified", "live", "work", "logs"});
  command->add_option("--size", options->size, "Side of the square for the whole distance transforms, cells")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(CLI::Range(std::uint32_t{32}, kLargestSize))
      ->capture_default_str();
  command->add_option("--samples", options->timing.samples, "Samples of each time at most; the median counts")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_log_options(*command, *options);
  command
      ->add_option("--megabytes", options->logs.megabytes,
                   "Size of the drive that logs reads, as an MCAP file that is not packed, in 1e6 bytes")
      ->type_name("N")
      ->check(CLI::Range(0.1, 1.0e4))
      ->capture_default_str();
  add_comparison_options(*command, *options);
  command->add_flag("--flood-errors", options->flood_errors,
                    "Print a table of the errors of jump flooding from 512 to --size in place of times");
  command->add_flag("--json", options->json, "Print JSON");
  add_device_options(*command, options->device, false);
  command->footer(
      "With a device, the CPU is measured too and both stand side by side. Steps are put in line and waited for\n"
      "together, so that a submission's own time is shared; a time is that of one step, the median of the samples.\n"
      "\n"
      "Examples:\n  gdtslam bench\n  gdtslam bench --device vulkan --json\n  gdtslam bench pose_cost --isa avx2\n"
      "  gdtslam bench clouds\n  gdtslam bench viewer\n  gdtslam bench certified --log intel.clf.gz\n"
      "  gdtslam bench live --log intel.clf.gz --json\n"
      "  gdtslam bench live --log city.log.gz --speed 0 --no-loops --set map.max_megacells=4096\n"
      "  gdtslam bench work --device vulkan --log intel.clf.gz\n"
      "  gdtslam bench logs --megabytes 100\n"
      "  gdtslam bench --json > before.json; gdtslam bench --against before.json\n"
      "  gdtslam bench transform --size 4096 --json\n  gdtslam bench --flood-errors --size 4096");
  command->callback([options, &context] { context.run = [options] { return bench(*options); }; });
}

}  // namespace gdtslam
