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

#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/folders.hpp"
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
  CertifiedBenchJob certified{};
  LiveBenchJob live{};
  LogBenchJob logs{};
  bool json = false;
  bool flood_errors = false;
  [[nodiscard]] bool is_certified() const { return filter == "certified"; }
  [[nodiscard]] bool is_live() const { return filter == "live"; }
  [[nodiscard]] bool is_logs() const { return filter == "logs"; }
};

/// All rows of one backend, and what it is called.
struct Measured {
  std::string name;  ///< "cpu", "vulkan:0"
  DeviceInfo device;
  std::optional<Isa> isa;  ///< of a CPU
  Basis basis = Basis::kCpu;
  std::vector<BenchRow> rows;
};

const char* as_text(Basis basis) { return basis == Basis::kCpu ? "cpu" : basis == Basis::kDevice ? "device" : "wall"; }

double rate_of(const BenchRow& row, Basis basis) { return row.work / seconds_of(row.timing, basis); }

const BenchRow* same_row(const Measured& measured, const BenchRow& wanted) {
  for (const BenchRow& row : measured.rows) {
    if (row.group == wanted.group && row.name == wanted.name && row.variant == wanted.variant) return &row;
  }
  return nullptr;
}

/// How many times as fast as the CPU: by CPU time where the device is a CPU itself, else by wall time.
double times_cpu(const BenchRow& cpu, const BenchRow& row, Basis basis) {
  return basis == Basis::kCpu ? cpu.timing.cpu_s / row.timing.cpu_s : cpu.timing.wall_s / row.timing.wall_s;
}

template <class T>
Json json_or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json row_json(const BenchRow& row, const Measured& measured, const Measured& cpu) {
  Json json{{"on", measured.name},
            {"group", row.group},
            {"name", row.name},
            {"variant", row.variant},
            {"unit", row.unit},
            {"work", row.work},
            {"samples", row.timing.samples},
            {"wall_s", row.timing.wall_s},
            {"cpu_s", row.timing.cpu_s},
            {"cpu_fastest_s", row.timing.fastest_s},
            {"cpu_slowest_s", row.timing.slowest_s},
            {"device_s", json_or_null(row.timing.device_s)},
            {"basis", as_text(measured.basis)},
            {"rate", rate_of(row, measured.basis)},
            {"copy_ratio", json_or_null(row.copy_ratio)},
            {"times_opencv", json_or_null(row.times_opencv)},
            {"different_cells", json_or_null(row.different)}};
  const BenchRow* const beside = &measured != &cpu ? same_row(cpu, row) : nullptr;
  json["times_cpu"] = beside != nullptr ? Json(times_cpu(*beside, row, measured.basis)) : Json();
  return json;
}

Json report_json(const std::vector<Measured>& all) {
  Json devices = Json::array();
  Json list = Json::array();
  for (const Measured& measured : all) {
    Json device = device_json(measured.device);
    device["device"] = measured.name;
    if (measured.isa) device["isa"] = to_string(*measured.isa);
    devices.push_back(std::move(device));
    for (const BenchRow& row : measured.rows) list.push_back(row_json(row, measured, all.front()));
  }
  const std::string opencv = opencv_version();
  return {{"version", GDTSLAM_VERSION},
          {"devices", devices},
          {"opencv", opencv.empty() ? Json() : Json(opencv)},
          {"rows", list}};
}

std::string device_line(const Measured& measured) {
  const DeviceInfo& device = measured.device;
  return fmt::format("{:<9} {} ({}, {}), {} thread{}\n", measured.name, device.name, device.kind, device.driver,
                     device.threads, device.threads == 1 ? "" : "s");
}

std::string microseconds(double seconds) { return fmt::format("{:.1f}", seconds * 1e6); }

std::string share_text(const BenchRow& row) { return row.copy_ratio ? fmt::format("{:.2f}", *row.copy_ratio) : ""; }

/// Widths of the first two columns, which hold names.
struct NameWidths {
  std::size_t name = 0;
  std::size_t variant = 0;
  explicit NameWidths(const std::vector<BenchRow>& rows) {
    for (const BenchRow& row : rows) {
      name = std::max(name, row.name.size());
      variant = std::max(variant, row.variant.size());
    }
  }
};

// Three digits: a rate may be 1e-4 or 40 thousand million a second.
std::string giga(double rate) { return fmt::format("{:.3g}", rate * 1e-9); }

std::string line(const NameWidths& widths, const std::string& name, const std::string& variant,
                 const std::string& columns) {
  return fmt::format("{:<{}}  {:<{}} {}\n", name, widths.name, variant, widths.variant, columns);
}

constexpr std::string_view kCpuColumns = "{:>10} {:>18} {:>10} {:>14} {:>6} {:>8} {:>9}";

std::string cpu_row_text(const NameWidths& widths, const BenchRow& row) {
  const Timing& time = row.timing;
  return line(widths, row.name, row.variant,
              fmt::format(kCpuColumns, microseconds(time.cpu_s),
                          microseconds(time.fastest_s) + "-" + microseconds(time.slowest_s), microseconds(time.wall_s),
                          giga(rate_of(row, Basis::kCpu)) + " G " + row.unit, share_text(row),
                          row.times_opencv ? fmt::format("{:.1f}", *row.times_opencv) : "",
                          row.different ? std::to_string(*row.different) : ""));
}

std::string cpu_report(const Measured& cpu) {
  const NameWidths widths(cpu.rows);
  std::string text = fmt::format("gdtslam {}\n", GDTSLAM_VERSION) + device_line(cpu);
  text +=
      line(widths, "", "",
           fmt::format(kCpuColumns, "CPU us", "spread", "wall us", "per CPU second", "copy", "xOpenCV", "different"));
  for (const BenchRow& row : cpu.rows) text += cpu_row_text(widths, row);
  text += "copy: time of a plain copy of the bytes read and written, over the time. ";
  text += opencv_version().empty() ? "This build has no OpenCV to compare with.\n"
                                   : "xOpenCV: CPU time of OpenCV's precise transform over ours. different: cells that "
                                     "are not those of the exact transform.\n";
  return text;
}

constexpr std::string_view kPairColumns = "{:>9} | {:>10} {:>8} {:>5} | {:>10} {:>10} {:>10} {:>10} {:>5} | {:>7}";

std::string pair_row_text(const NameWidths& widths, const BenchRow& row, const Measured& device, const Measured& cpu) {
  const BenchRow* const beside = same_row(cpu, row);
  const bool has_cpu = beside != nullptr;
  return line(
      widths, row.name, row.variant,
      fmt::format(kPairColumns, row.unit, has_cpu ? microseconds(beside->timing.wall_s) : "",
                  has_cpu ? giga(rate_of(*beside, cpu.basis)) : "", has_cpu ? share_text(*beside) : "",
                  microseconds(row.timing.wall_s), microseconds(row.timing.cpu_s),
                  row.timing.device_s ? microseconds(*row.timing.device_s) : "-", giga(rate_of(row, device.basis)),
                  share_text(row), has_cpu ? fmt::format("{:.2f}", times_cpu(*beside, row, device.basis)) : ""));
}

std::string pair_report(const Measured& cpu, const Measured& device) {
  const NameWidths widths(device.rows);
  std::string text = fmt::format("gdtslam {}\n", GDTSLAM_VERSION) + device_line(cpu) + device_line(device);
  text += fmt::format("{:<{}} | {:^25} | {:^49} |\n", "", widths.name + widths.variant + 12, "cpu", device.name);
  text += line(
      widths, "", "",
      fmt::format(kPairColumns, "unit", "wall us", "G/CPU s", "copy", "wall us", "CPU us", "device us",
                  fmt::format("G/{} s", device.basis == Basis::kCpu ? "CPU" : as_text(device.basis)), "copy", "x CPU"));
  for (const BenchRow& row : device.rows) text += pair_row_text(widths, row, device, cpu);
  text +=
      "wall us, CPU us: of the process, all its threads; device us: by the device's own clock. G/s: 1e9 units of work "
      "a second.\ncopy: time that the same processor takes to copy the bytes read and written, over the time. x CPU: "
      "times as fast as the CPU, by CPU time where the device is a CPU itself, else by wall time.\n";
  return text;
}

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
  if (measured.rows.empty()) throw UsageError("bench: no kernel's name contains '" + options.filter + "'");
  return measured;
}

ReadOptions read_of(const BenchOptions& options) {
  LogConfig config;
  state_recording(options.recording, config);
  return read_options_of(config, false);
}

int print_certified(Backend& cpu, const BenchOptions& options) {
  CertifiedBenchJob job = options.certified;
  job.log = options.log.empty() ? sample_log_file() : options.log;
  job.read = read_of(options);
  job.mapper = load_settings({}).mapper;
  print_result(bench_certified(
      job, cpu, [] { return interrupted(); }, options.json));
  return static_cast<int>(ExitCode::kDone);
}

int print_live(Backend& cpu, const BenchOptions& options) {
  LiveBenchJob job = options.live;
  job.log = options.log.empty() ? sample_log_file() : options.log;
  job.read = read_of(options);
  job.mapper = load_settings({}).mapper;
  job.options = on_failure_of(options.device);
  print_result(bench_live(
      job, cpu, [] { return interrupted(); }, options.json));
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

int bench(const BenchOptions& options) {
  if (!options.is_certified() && !options.is_live() && !options.log.empty()) {
    throw UsageError("bench: --log is for 'gdtslam bench certified' and 'gdtslam bench live'");
  }
  if (options.log.empty() && options.recording.are_stated()) {
    throw UsageError("bench: --topic, --odom, --crank and --mount are for a --log");
  }
  const std::unique_ptr<Backend> cpu = make_cpu(options.device);
  if (options.is_live()) return print_live(*cpu, options);
  if (options.is_certified()) return print_certified(*cpu, options);
  if (options.is_logs()) return print_logs(*cpu, options);
  const std::unique_ptr<VulkanBackend> device = make_vulkan(options.device, {.time_submissions = true});
  if (options.flood_errors) return print_flood_errors(device ? *device : *cpu, options);
  std::vector<Measured> all{measure_all(*cpu, "cpu", options)};
  if (device) {
    all.push_back(measure_all(*device, fmt::format("vulkan:{}", device->vulkan_device().index), options));
  }
  const std::string text = device ? pair_report(all.front(), all.back()) : cpu_report(all.front());
  print_result(options.json ? json_text(report_json(all)) : text);
  return static_cast<int>(ExitCode::kDone);
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
                   "that is mapped with loops, as it comes, on the CPU; 'logs': logs of every format read")
      ->type_name("NAME");
  command->add_option("--size", options->size, "Side of the square for the whole distance transforms, cells")
      ->type_name("N")
      ->check(CLI::Range(std::uint32_t{32}, kLargestSize).description(""))
      ->capture_default_str();
  command->add_option("--samples", options->timing.samples, "Samples of each time at most; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000).description(""))
      ->capture_default_str();
  command
      ->add_option("--log", options->log,
                   "certified, live: the log that is mapped (default: the sample that comes along)")
      ->type_name("LOG");
  add_recording_options(*command, options->recording);
  command->add_option("--scans", options->certified.scans, "certified: scans that are looked for, evenly over the log")
      ->type_name("N")
      ->check(CLI::Range(1, 100000).description(""))
      ->capture_default_str();
  add_quantity_option(*command, "--lattice", options->certified.lattice_s, Unit::kSecond, {0.0, 1.0e6},
                      "certified: CPU time for the lattice beside it in each window, one search at least; 0: none")
      ->default_str(format_quantity(options->certified.lattice_s, Unit::kSecond));
  command
      ->add_option("--speed", options->live.speed,
                   "live: scans come so many times as fast as their stamps say; 0: as fast as they are done")
      ->type_name("N")
      ->check(CLI::Range(0.0, 1.0e6).description(""))
      ->capture_default_str();
  command
      ->add_option("--megabytes", options->logs.megabytes,
                   "logs: size of the drive, as an MCAP file that is not packed, in 1e6 bytes")
      ->type_name("N")
      ->check(CLI::Range(0.1, 1.0e4).description(""))
      ->capture_default_str();
  command->add_flag("--flood-errors", options->flood_errors,
                    "Instead of times: the errors of jump flooding from 512 to --size, as a table");
  command->add_flag("--json", options->json, "Print JSON");
  add_device_options(*command, options->device, false);
  command->footer(
      "With a device, the CPU is measured too and both stand side by side. Steps are put in line and waited for\n"
      "together, so that a submission's own time is shared; a time is that of one step, the median of the samples.\n"
      "\n"
      "Examples:\n  gdtslam bench\n  gdtslam bench --device vulkan --json\n  gdtslam bench pose_cost --isa avx2\n"
      "  gdtslam bench clouds\n  gdtslam bench viewer\n  gdtslam bench certified --log intel.clf.gz\n"
      "  gdtslam bench live --log intel.clf.gz --json\n"
      "  gdtslam bench logs --megabytes 100\n"
      "  gdtslam bench transform --size 4096 --json\n  gdtslam bench --flood-errors --size 4096");
  command->callback([options, &context] { context.run = [options] { return bench(*options); }; });
}

}  // namespace gdtslam
