#include "queue_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/quantile.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using WorkJson = nlohmann::ordered_json;
using WorkClock = std::chrono::steady_clock;

std::optional<double> median_of(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  return upper_median(values);
}

double a_scan(const ScanWork& scans, std::uint64_t count) {
  return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(1, scans.scans));
}

struct WorkRow {
  const char* name;
  std::uint64_t QueueWork::*count;
};
constexpr WorkRow kWorkRows[] = {
    {"barriers", &QueueWork::barriers},   {"submissions", &QueueWork::submissions},
    {"waits", &QueueWork::waits},         {"fills", &QueueWork::fills},
    {"uploads", &QueueWork::uploads},     {"upload_bytes", &QueueWork::upload_bytes},
    {"downloads", &QueueWork::downloads}, {"download_bytes", &QueueWork::download_bytes},
};

WorkJson json_of(const ScanWork& scans) {
  WorkJson json{{"scans", scans.scans},
                {"windows", a_scan(scans, scans.windows)},
                {"evaluations", a_scan(scans, scans.evaluations)}};
  json["dispatches"] = a_scan(scans, scans.work.dispatch_sum());
  for (const WorkRow& row : kWorkRows) json[row.name] = a_scan(scans, scans.work.*row.count);
  json["kernels"] = WorkJson::object();
  for (const auto& [kernel, count] : scans.work.dispatches) json["kernels"][std::string(kernel)] = a_scan(scans, count);
  const auto put = [&json](const char* key, const std::optional<double>& value) {
    json[key] = value ? WorkJson(*value) : WorkJson(nullptr);
  };
  put("median_s", median_of(scans.scan_s));
  put("device_s", median_of(scans.device_s));
  return json;
}

std::string text_of(const WorkBenchJob& job, const WorkBench& bench, const VulkanBackend& backend) {
  const std::string name = log_name(job.log);
  std::string text = fmt::format("gdtslam {}\n{}: {}\n{}: {} keyframes, {} other scans; of each, on average\n",
                                 GDTSLAM_VERSION, backend.device().name, backend.device().driver,
                                 name.substr(name.rfind('/') + 1), bench.keyframes.scans, bench.others.scans);
  const auto line = [&text](std::string_view what, double keyframe, double other) {
    text += fmt::format("{:16} {:12.2f} {:12.2f}\n", what, keyframe, other);
  };
  text += fmt::format("{:16} {:>12} {:>12}\n", "", "keyframe", "other scan");
  line("windows", a_scan(bench.keyframes, bench.keyframes.windows), a_scan(bench.others, bench.others.windows));
  line("poses costed", a_scan(bench.keyframes, bench.keyframes.evaluations),
       a_scan(bench.others, bench.others.evaluations));
  line("dispatches", a_scan(bench.keyframes, bench.keyframes.work.dispatch_sum()),
       a_scan(bench.others, bench.others.work.dispatch_sum()));
  QueueWork both = bench.keyframes.work;
  both += bench.others.work;
  for (const auto& [kernel, count] : both.dispatches) {
    const auto of = [kernel = kernel](const ScanWork& scans) {
      const auto found = scans.work.dispatches.find(kernel);
      return found == scans.work.dispatches.end() ? 0.0 : a_scan(scans, found->second);
    };
    line(fmt::format("  {}", kernel), of(bench.keyframes), of(bench.others));
  }
  for (const WorkRow& row : kWorkRows) {
    line(row.name, a_scan(bench.keyframes, bench.keyframes.work.*row.count),
         a_scan(bench.others, bench.others.work.*row.count));
  }
  line("median, us", 1.0e6 * median_of(bench.keyframes.scan_s).value_or(0.0),
       1.0e6 * median_of(bench.others.scan_s).value_or(0.0));
  if (!bench.keyframes.device_s.empty() || !bench.others.device_s.empty()) {
    line("on the device, us", 1.0e6 * median_of(bench.keyframes.device_s).value_or(0.0),
         1.0e6 * median_of(bench.others.device_s).value_or(0.0));
  }
  return text;
}

void take_scan(const ScanRecord& record, Mapper& mapper, VulkanBackend& backend, WorkBench& bench) {
  const QueueWork before = backend.work();
  const MapperStatistics mapped = mapper.statistics();
  const WorkClock::time_point start = WorkClock::now();
  const bool is_keyframe = mapper.process(record.scan, record.T_odom_base).merged;
  const std::chrono::duration<double> taken = WorkClock::now() - start;
  ScanWork& scans = is_keyframe ? bench.keyframes : bench.others;
  ++scans.scans;
  scans.windows += mapper.statistics().attempts - mapped.attempts;
  scans.evaluations += mapper.statistics().evaluations - mapped.evaluations;
  const QueueWork work = backend.work() - before;
  scans.work += work;
  scans.scan_s.push_back(taken.count());
  // Without a wait of its own the device's time is that of an earlier scan.
  if (const double device_ns = backend.last_submission_ns(); work.waits > 0 && device_ns > 0.0) {
    scans.device_s.push_back(1.0e-9 * device_ns);
  }
}

}  // namespace

WorkBench run_work(const WorkBenchJob& job, VulkanBackend& backend, const std::function<bool()>& stop) {
  WorkBench bench;
  Mapper mapper(job.mapper, backend, {.fall_back = false, .cpu = {}, .warn = {}});
  ScanStream scans({job.log}, job.read, {});
  while (const std::optional<ScanRecord> record = scans.next()) {
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
    take_scan(*record, mapper, backend, bench);
  }
  if (bench.keyframes.scans == 0) throw InputError(FilePosition{log_name(job.log), 0}, "holds no laser scan");
  return bench;
}

std::string bench_work(const WorkBenchJob& job, VulkanBackend& backend, const std::function<bool()>& stop,
                       bool is_json) {
  const WorkBench bench = run_work(job, backend, stop);
  if (!is_json) return text_of(job, bench, backend);
  const std::string name = log_name(job.log);
  return json_text(WorkJson{{"version", GDTSLAM_VERSION},
                            {"device", backend.device().name},
                            {"driver", backend.device().driver},
                            {"log", name.substr(name.rfind('/') + 1)},
                            {"keyframe", json_of(bench.keyframes)},
                            {"other_scan", json_of(bench.others)}});
}

}  // namespace gdtslam
