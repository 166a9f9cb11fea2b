// Times of a mapper for each scan of a log that is replayed at the pace of its stamps, only faster; with loops, these
// are searched in parallel. The poses depend on the log and the configuration alone, the times on the machine.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using LiveClock = std::chrono::steady_clock;

constexpr double kLongestPause_s = 10.0;  // between two scans, by their stamps, because robots pause at night
constexpr auto kNap = std::chrono::milliseconds(50);
constexpr double kLong_s = 0.05;  // limit for a robot that steers by the pose
constexpr std::size_t kParts = 10;

/// One scan, from its arrival to its pose.
struct LiveScan {
  double all_s = 0.0;
  double cpu_s = 0.0;  ///< CPU time of the mapping thread; other work on the machine does not lengthen it
  bool is_keyframe = false;
  double merge_s = 0.0;  ///< its local field, and merging it
};

double cpu_of_this_thread_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1.0e-9 * static_cast<double>(time.tv_nsec);
}

/// A mapper with or without loops, and the times of its scans.
class LiveRun {
 public:
  LiveRun(const BenchLog& log, Backend& backend) : log_(log), mapper_(log.mapper, backend, with_loops(log)) {}

  void run() {
    ScanStream scans({log_.file}, log_.read, {});
    while (const std::optional<ScanRecord> record = scans.next()) {
      wait_for(record->scan.stamp_s);
      take(*record);
    }
    if (scans_.empty()) throw InputError(FilePosition{log_name(log_.file), 0}, "holds no laser scan");
  }

  void count(benchmark::State& state) const {
    add_shares(state, "", &LiveScan::all_s);
    add_shares(state, "cpu_", &LiveScan::cpu_s);
    const auto set = [&state](const std::string& name, auto value) {
      state.counters[name] = static_cast<double>(value);
    };
    set("scans", scans_.size());
    set("keyframes", mapper_.statistics().keyframes);
    set("late", late_);
    set("above_50_ms",
        std::count_if(scans_.begin(), scans_.end(), [](const LiveScan& scan) { return scan.all_s > kLong_s; }));
    if (mapper_.loops() != nullptr) {
      const LiveStatistics loops = mapper_.loops()->statistics();
      set("places", loops.places);
      set("corrections", loops.corrections);
      set("waits", loops.waits);
      set("waited_s", loops.waited_s);
      set("beside_cpu_s", loops.beside_cpu_s);
    }
    for (std::size_t part = 0; part < kParts; ++part) add_part(state, part);
  }

 private:
  static MapperOptions with_loops(const BenchLog& log) {
    MapperOptions options = log.options;
    options.with_loops = log.loops;
    return options;
  }

  // Waits until the scan is due; a scan that arrived while the mapper was busy is already late.
  void wait_for(double stamp_s) {
    if (last_stamp_s_ && log_.speed > 0.0) {
      const double pause_s = std::clamp(stamp_s - *last_stamp_s_, 0.0, kLongestPause_s) / log_.speed;
      due_ += std::chrono::duration_cast<LiveClock::duration>(std::chrono::duration<double>(pause_s));
      if (pause_s > 0.0 && done_ > due_) ++late_;
    }
    last_stamp_s_ = stamp_s;
    while (true) {
      if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
      const LiveClock::time_point now = LiveClock::now();
      if (now >= due_) return;
      std::this_thread::sleep_until(std::min(due_, now + kNap));
    }
  }

  void take(const ScanRecord& record) {
    const StageTimes before = mapper_.statistics().stages;
    const double cpu_s = cpu_of_this_thread_s();
    const LiveClock::time_point start = LiveClock::now();
    LiveScan scan{.is_keyframe = mapper_.process(record.scan, record.T_odom_base).merged};
    done_ = LiveClock::now();
    scan.all_s = std::chrono::duration<double>(done_ - start).count();
    scan.cpu_s = cpu_of_this_thread_s() - cpu_s;
    const StageTimes after = mapper_.statistics().stages;
    scan.merge_s = after.local_field_s - before.local_field_s + after.merge_s - before.merge_s;
    scans_.push_back(scan);
  }

  void add_shares(benchmark::State& state, const std::string& of, double LiveScan::*time) const {
    std::vector<double> times_s;
    for (const LiveScan& scan : scans_) times_s.push_back(scan.*time);
    for (const auto& [name, share] :
         {std::pair{"median_s", 0.5}, {"p99_s", 0.99}, {"p999_s", 0.999}, {"largest_s", 1.0}}) {
      state.counters[of + name] = value_at_share(times_s, share);
    }
  }

  // A part of the log, to show times that grow with the map.
  void add_part(benchmark::State& state, std::size_t part) const {
    const std::size_t first = part * scans_.size() / kParts;
    const std::size_t end = (part + 1) * scans_.size() / kParts;
    double keyframes = 0.0;
    double cpu_s = 0.0;
    double merge_s = 0.0;
    for (std::size_t k = first; k < end; ++k) {
      if (!scans_[k].is_keyframe) continue;
      keyframes += 1.0;
      cpu_s += scans_[k].cpu_s;
      merge_s += scans_[k].merge_s;
    }
    const std::string name = "part" + std::to_string(part) + "_";
    state.counters[name + "first"] = static_cast<double>(first);
    state.counters[name + "scans"] = static_cast<double>(end - first);
    state.counters[name + "keyframes"] = keyframes;
    state.counters[name + "keyframe_cpu_s"] = cpu_s / std::max(1.0, keyframes);
    state.counters[name + "keyframe_merge_s"] = merge_s / std::max(1.0, keyframes);
  }

  const BenchLog& log_;
  Mapper mapper_;
  std::vector<LiveScan> scans_;
  std::size_t late_ = 0;  ///< scans that arrived before the previous one was done
  LiveClock::time_point due_ = LiveClock::now();
  LiveClock::time_point done_ = due_;  // end of the previous scan
  std::optional<double> last_stamp_s_;
};

}  // namespace

void add_live(const BenchTarget& cpu, const BenchLog& log) {
  add_row(cpu, "live", "log", log.loops ? "with loops" : "without loops",
          [log, &backend = cpu.backend](benchmark::State& state) {
            for (auto _ : state) {
              LiveRun run(log, backend);
              run.run();
              run.count(state);
            }
          })
      ->Iterations(1);
}

}  // namespace gdtslam
