#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "engine/runs/folder/run_report.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

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
  const Basis basis = basis_of(row.timing, measured.basis);
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
            {"basis", to_string(basis)},
            {"rate", rate_of(row, basis)},
            {"samples_s", samples_of(row.timing, basis)},
            {"copy_ratio", json_or_null(row.copy_ratio)},
            {"load_ratio", json_or_null(row.load_ratio)},
            {"times_opencv", json_or_null(row.times_opencv)},
            {"different_cells", json_or_null(row.different)}};
  const BenchRow* const beside = &measured != &cpu ? same_row(cpu, row) : nullptr;
  json["times_cpu"] = beside != nullptr ? Json(times_cpu(*beside, row, measured.basis)) : Json();
  return json;
}

std::string device_line(const Measured& measured) {
  const DeviceInfo& device = measured.device;
  return fmt::format("{:<9} {} ({}, {}), {} thread{}\n", measured.name, device.name, device.kind, device.driver,
                     device.threads, device.threads == 1 ? "" : "s");
}

std::string microseconds(double seconds) { return fmt::format("{:.1f}", seconds * 1e6); }

/// Of what the machine does at most.
std::string limit_text(const BenchRow& row) {
  if (row.copy_ratio) return fmt::format("copy {:.2f}", *row.copy_ratio);
  return row.load_ratio ? fmt::format("load {:.2f}", *row.load_ratio) : "";
}

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

constexpr std::string_view kCpuColumns = "{:>10} {:>18} {:>10} {:>14} {:>10} {:>8} {:>9}";

std::string cpu_row_text(const NameWidths& widths, const BenchRow& row) {
  const Timing& time = row.timing;
  return line(widths, row.name, row.variant,
              fmt::format(kCpuColumns, microseconds(time.cpu_s),
                          microseconds(time.fastest_s) + "-" + microseconds(time.slowest_s), microseconds(time.wall_s),
                          giga(rate_of(row, Basis::kCpu)) + " G " + row.unit, limit_text(row),
                          row.times_opencv ? fmt::format("{:.1f}", *row.times_opencv) : "",
                          row.different ? std::to_string(*row.different) : ""));
}

constexpr std::string_view kPairColumns = "{:>9} | {:>10} {:>8} {:>9} | {:>10} {:>10} {:>10} {:>10} {:>9} | {:>7}";

std::string pair_row_text(const NameWidths& widths, const BenchRow& row, const Measured& device, const Measured& cpu) {
  const BenchRow* const beside = same_row(cpu, row);
  const bool has_cpu = beside != nullptr;
  const bool is_rated = basis_of(row.timing, device.basis) == device.basis;  // as the head of the column says
  return line(widths, row.name, row.variant,
              fmt::format(kPairColumns, row.unit, has_cpu ? microseconds(beside->timing.wall_s) : "",
                          has_cpu ? giga(rate_of(*beside, cpu.basis)) : "", has_cpu ? limit_text(*beside) : "",
                          microseconds(row.timing.wall_s), microseconds(row.timing.cpu_s),
                          row.timing.device_s ? microseconds(*row.timing.device_s) : "-",
                          is_rated ? giga(rate_of(row, device.basis)) : "-", limit_text(row),
                          has_cpu ? fmt::format("{:.2f}", times_cpu(*beside, row, device.basis)) : ""));
}

}  // namespace

Json bench_json(const std::vector<Measured>& all) {
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

std::string cpu_report(const Measured& cpu) {
  const NameWidths widths(cpu.rows);
  std::string text = fmt::format("gdtslam {}\n", GDTSLAM_VERSION) + device_line(cpu);
  text += line(
      widths, "", "",
      fmt::format(kCpuColumns, "CPU us", "spread", "wall us", "per CPU second", "of limit", "xOpenCV", "different"));
  for (const BenchRow& row : cpu.rows) text += cpu_row_text(widths, row);
  text +=
      "of limit: copy: time of a plain copy of the bytes read and written, over the time; load: look-ups a second over "
      "the most random loads a second above (a bilinear look-up is four cells; a bound's load stands for many "
      "look-ups). ";
  text += opencv_version().empty() ? "This build has no OpenCV to compare with.\n"
                                   : "xOpenCV: CPU time of OpenCV's precise transform over ours. different: cells that "
                                     "are not those of the exact transform.\n";
  return text;
}

std::string pair_report(const Measured& cpu, const Measured& device) {
  const NameWidths widths(device.rows);
  std::string text = fmt::format("gdtslam {}\n", GDTSLAM_VERSION) + device_line(cpu) + device_line(device);
  text += fmt::format("{:<{}} | {:^29} | {:^53} |\n", "", widths.name + widths.variant + 12, "cpu", device.name);
  text += line(widths, "", "",
               fmt::format(kPairColumns, "unit", "wall us", "G/CPU s", "of limit", "wall us", "CPU us", "device us",
                           fmt::format("G/{} s", device.basis == Basis::kCpu ? "CPU" : to_string(device.basis)),
                           "of limit", "x CPU"));
  for (const BenchRow& row : device.rows) text += pair_row_text(widths, row, device, cpu);
  text +=
      "wall us, CPU us: of the process, all its threads; device us: by the device's own clock. G/s: 1e9 units of work "
      "a second.\nof limit: copy: time that the same processor takes to copy the bytes read and written, over the "
      "time; "
      "load: look-ups a second over the most random loads a second. x CPU: "
      "times as fast as the CPU, by CPU time where the device is a CPU itself, else by wall time.\n";
  return text;
}

}  // namespace gdtslam
