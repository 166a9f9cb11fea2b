// gdtslam bench: how fast the kernels are here, beside a plain copy and beside OpenCV where the build has it.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "bench_rows.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "device_option.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/json_file.hpp"
#include "interrupt.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kLargestSize = 8192;

struct BenchOptions {
  DeviceOptions device;
  std::string filter;
  std::uint32_t size = 1024;
  TimingOptions timing;
  bool json = false;
  bool flood_errors = false;
};

Json device_json(const Backend& backend) {
  const DeviceInfo& device = backend.device();
  Json json{{"name", device.name}, {"kind", device.kind}, {"driver", device.driver}, {"threads", device.threads}};
  if (device.kind == "cpu") json["isa"] = name_of(backend.host_isa());
  return json;
}

Json row_json(const BenchRow& row) {
  Json json{{"group", row.group},
            {"name", row.name},
            {"variant", row.variant},
            {"unit", row.unit},
            {"work", row.work},
            {"samples", row.timing.samples},
            {"wall_s", row.timing.wall_s},
            {"cpu_s", row.timing.cpu_s},
            {"cpu_fastest_s", row.timing.fastest_s},
            {"cpu_slowest_s", row.timing.slowest_s},
            {"per_cpu_s", row.work / row.timing.cpu_s}};
  json["copy_ratio"] = row.copy_ratio ? Json(*row.copy_ratio) : Json();
  json["times_opencv"] = row.times_opencv ? Json(*row.times_opencv) : Json();
  json["different_cells"] = row.different ? Json(*row.different) : Json();
  return json;
}

Json report_json(const Backend& backend, const std::vector<BenchRow>& rows) {
  Json list = Json::array();
  for (const BenchRow& row : rows) list.push_back(row_json(row));
  const std::string opencv = opencv_version();
  return {{"version", GDTSLAM_VERSION},
          {"device", device_json(backend)},
          {"opencv", opencv.empty() ? Json() : Json(opencv)},
          {"rows", list}};
}

std::string device_line(const Backend& backend) {
  const DeviceInfo& device = backend.device();
  return fmt::format("gdtslam {} on {} ({}, {}), {} thread{}\n", GDTSLAM_VERSION, device.name, device.kind,
                     device.driver, device.threads, device.threads == 1 ? "" : "s");
}

std::string row_text(const BenchRow& row) {
  const std::string rate = fmt::format("{:.3f} G {}s", row.work / row.timing.cpu_s * 1e-9, row.unit);
  const std::string spread = fmt::format("{:.1f}-{:.1f}", row.timing.fastest_s * 1e6, row.timing.slowest_s * 1e6);
  const std::string copy = row.copy_ratio ? fmt::format("{:.2f}", *row.copy_ratio) : "";
  const std::string opencv = row.times_opencv ? fmt::format("{:.1f}", *row.times_opencv) : "";
  const std::string different = row.different ? fmt::format("{}", *row.different) : "";
  return fmt::format("{:<20} {:<58} {:>10.1f} {:>18} {:>10.1f} {:>17} {:>6} {:>8} {:>9}\n", row.name, row.variant,
                     row.timing.cpu_s * 1e6, spread, row.timing.wall_s * 1e6, rate, copy, opencv, different);
}

std::string report_text(const Backend& backend, const std::vector<BenchRow>& rows) {
  std::string text = device_line(backend);
  text += fmt::format("{:<20} {:<58} {:>10} {:>18} {:>10} {:>17} {:>6} {:>8} {:>9}\n", "", "", "CPU us", "spread",
                      "wall us", "per CPU second", "copy", "xOpenCV", "different");
  for (const BenchRow& row : rows) text += row_text(row);
  text += "copy: time of a plain copy of the bytes read and written, over the time. ";
  text += opencv_version().empty() ? "This build has no OpenCV to compare with.\n"
                                   : "xOpenCV: CPU time of OpenCV's precise transform over ours. "
                                     "different: cells that are not those of the exact transform.\n";
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
  const Json report{{"version", GDTSLAM_VERSION}, {"device", device_json(backend)}, {"jump_flood_errors", list}};
  print_result(options.json ? json_text(report) : text);
  return static_cast<int>(ExitCode::kDone);
}

int bench(const BenchOptions& options) {
  const std::unique_ptr<Backend> backend = make_backend(options.device);
  if (options.flood_errors) return print_flood_errors(*backend, options);
  std::vector<BenchRow> rows = bench_kernels(*backend, options.filter, options.timing);
  if (options.filter.empty() || std::string_view("transform").find(options.filter) != std::string_view::npos) {
    for (BenchRow& row : bench_transforms(*backend, options.size, options.timing)) rows.push_back(std::move(row));
  }
  if (rows.empty()) throw UsageError("bench: no kernel's name contains '" + options.filter + "'");
  print_result(options.json ? json_text(report_json(*backend, rows)) : report_text(*backend, rows));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_bench_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* command = app.add_subcommand("bench", "How fast the kernels are here, beside a plain copy and OpenCV");
  command->add_option("filter", options->filter, "Only kernels whose name contains this; 'transform': whole transforms")
      ->type_name("NAME");
  command->add_option("--size", options->size, "Side of the square for the whole distance transforms, cells")
      ->type_name("N")
      ->check(CLI::Range(std::uint32_t{32}, kLargestSize).description(""))
      ->capture_default_str();
  command->add_option("--samples", options->timing.samples, "Samples of each time; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000).description(""))
      ->capture_default_str();
  command->add_flag("--flood-errors", options->flood_errors,
                    "Instead of times: the errors of jump flooding from 512 to --size, as a table");
  command->add_flag("--json", options->json, "Print JSON");
  add_device_options(*command, options->device);
  command->footer(
      "Examples:\n  gdtslam bench\n  gdtslam bench pose_cost --isa avx2\n"
      "  gdtslam bench transform --size 4096 --json\n  gdtslam bench --flood-errors --size 4096");
  command->callback([options, &context] { context.run = [options] { return bench(*options); }; });
}

}  // namespace gdtslam
