// Rows of the group `work`: device work per scan, for keyframes and for the other scans. The counts depend on the log,
// the configuration and the device's shaders, the times on the machine.
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using WorkClock = std::chrono::steady_clock;

/// Totals over the scans of one kind.
struct ScanWork {
  std::uint64_t scans = 0;
  std::uint64_t windows = 0;
  std::uint64_t evaluations = 0;  ///< poses costed: samples of the windows, and steps of all descents
  QueueWork work;                 ///< sum over the scans
  std::vector<double> scan_s;     ///< time from the arrival of each scan to its pose
  std::vector<double> device_s;   ///< device time of the last submission that each scan waited for
};

struct WorkBench {
  ScanWork keyframes;
  ScanWork others;
};

void count_scans(benchmark::State& state, ScanWork scans) {
  if (scans.scans == 0) {
    state.SkipWithError("the log has no such scan");
    return;
  }
  for (auto _ : state) state.SetIterationTime(upper_median(scans.scan_s));
  const auto set = [&state, &scans](const std::string& name, std::uint64_t count) {
    state.counters[name] = static_cast<double>(count) / static_cast<double>(scans.scans);
  };
  state.counters["scans"] = static_cast<double>(scans.scans);
  set("windows", scans.windows);
  set("evaluations", scans.evaluations);
  set("dispatches", scans.work.dispatch_sum());
  for (const auto& [kernel, count] : scans.work.dispatches) set("kernel " + std::string(kernel), count);
  set("barriers", scans.work.barriers);
  set("submissions", scans.work.submissions);
  set("waits", scans.work.waits);
  set("fills", scans.work.fills);
  set("uploads", scans.work.uploads);
  set("upload_bytes", scans.work.upload_bytes);
  set("downloads", scans.work.downloads);
  set("download_bytes", scans.work.download_bytes);
  if (!scans.device_s.empty()) state.counters["device_s"] = upper_median(scans.device_s);
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
  // If this scan did not wait for the device, the device's time belongs to an earlier scan.
  if (const double device_ns = backend.last_submission_ns(); work.waits > 0 && device_ns > 0.0) {
    scans.device_s.push_back(1.0e-9 * device_ns);
  }
}

WorkBench run_work(const BenchLog& log, VulkanBackend& backend) {
  WorkBench bench;
  Mapper mapper(log.mapper, backend, {.fall_back = false, .cpu = {}, .warn = {}});
  ScanStream scans({log.file}, log.read, {});
  while (const std::optional<ScanRecord> record = scans.next()) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
    take_scan(*record, mapper, backend, bench);
  }
  if (bench.keyframes.scans == 0) throw InputError(FilePosition{log_name(log.file), 0}, "holds no laser scan");
  return bench;
}

}  // namespace

void add_work(const BenchTarget& device, const BenchLog& log) {
  const auto bench = shared_by_rows([log, &backend = dynamic_cast<VulkanBackend&>(device.backend)] {
    return std::make_shared<WorkBench>(run_work(log, backend));
  });
  for (const auto& [name, scans] :
       {std::pair{"keyframe", &WorkBench::keyframes}, std::pair{"other scan", &WorkBench::others}}) {
    add_row(device, "work", name, "exhaustive",
            [bench, scans = scans](benchmark::State& state) { count_scans(state, bench().*scans); })
        ->Iterations(1)
        ->UseManualTime();
  }
}

}  // namespace gdtslam
