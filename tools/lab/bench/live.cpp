#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

using LiveClock = std::chrono::steady_clock;

constexpr double kLongestPause_s = 10.0;  // between two scans, by their stamps: robots stand at night
constexpr double kLong_s = 0.05;          // of a scan, for whoever steers by its pose
constexpr auto kNap = std::chrono::milliseconds(50);

double seconds_since(LiveClock::time_point start) {
  return std::chrono::duration<double>(LiveClock::now() - start).count();
}

/// One scan, from its coming to its pose.
struct LiveScan {
  std::size_t index = 0;
  double all_s = 0.0;
  double waited_s = 0.0;  ///< for loops
  bool is_keyframe = false;
  StageTimes stages{};
};

struct LiveBench {
  std::vector<double> scan_s;
  LiveScan largest;
  std::size_t above_50_ms = 0;
  std::size_t late = 0;  ///< scans that came before the one before them was done
  double lasted_s = 0.0;
  double busy_s = 0.0;  ///< of that in the mapper
  LiveStatistics loops;
  std::uint64_t keyframes = 0;
};

StageTimes less(const StageTimes& a, const StageTimes& b) {
  return {a.predict_s - b.predict_s, a.match_s - b.match_s, a.local_field_s - b.local_field_s, a.merge_s - b.merge_s};
}

class LiveBenchRun {
 public:
  LiveBenchRun(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop)
      : job_(job), stop_(stop), mapper_(job.mapper, backend, job.options) {}

  LiveBench run() {
    ScanStream scans({job_.log}, job_.read, {});
    const LiveClock::time_point start = LiveClock::now();
    while (const std::optional<ScanRecord> record = scans.next()) {
      wait_for(record->scan.stamp_s);
      take(*record);
    }
    if (bench_.scan_s.empty()) throw InputError(FilePosition{log_name(job_.log), 0}, "holds no laser scan");
    bench_.lasted_s = seconds_since(start);
    bench_.loops = mapper_.live_statistics();
    bench_.keyframes = mapper_.front_end().statistics().keyframes;
    return std::move(bench_);
  }

 private:
  // Until the scan comes; one that the mapper was not ready for has come already.
  void wait_for(double stamp_s) {
    if (last_stamp_s_ && job_.speed > 0.0) {
      const double pause_s = std::clamp(stamp_s - *last_stamp_s_, 0.0, kLongestPause_s) / job_.speed;
      due_ += std::chrono::duration_cast<LiveClock::duration>(std::chrono::duration<double>(pause_s));
      if (pause_s > 0.0 && done_ > due_) ++bench_.late;
    }
    last_stamp_s_ = stamp_s;
    while (true) {
      if (stop_()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
      const LiveClock::time_point now = LiveClock::now();
      if (now >= due_) return;
      std::this_thread::sleep_until(std::min(due_, now + kNap));
    }
  }

  void take(const ScanRecord& record) {
    const StageTimes stages = mapper_.front_end().statistics().stages;
    const double waited_s = mapper_.live_statistics().waited_s;
    LiveScan scan{.index = bench_.scan_s.size()};
    const LiveClock::time_point start = LiveClock::now();
    mapper_.start(record.scan, record.T_odom_base);
    scan.is_keyframe = mapper_.finish().merged;
    scan.all_s = seconds_since(start);
    done_ = LiveClock::now();
    if (scan.all_s > kLong_s) ++bench_.above_50_ms;
    bench_.scan_s.push_back(scan.all_s);
    bench_.busy_s += scan.all_s;
    if (scan.all_s <= bench_.largest.all_s) return;
    scan.waited_s = mapper_.live_statistics().waited_s - waited_s;
    scan.stages = less(mapper_.front_end().statistics().stages, stages);
    bench_.largest = scan;
  }

  LiveBenchJob job_;
  std::function<bool()> stop_;
  LoopMapper mapper_;
  LiveBench bench_;
  LiveClock::time_point due_ = LiveClock::now();
  LiveClock::time_point done_ = due_;  // the scan before
  std::optional<double> last_stamp_s_;
};

double milliseconds(double seconds) { return 1.0e3 * seconds; }

std::string live_text(const LiveBenchJob& job, LiveBench& bench, const Backend& backend) {
  const DeviceInfo& device = backend.device();
  const LiveScan& worst = bench.largest;
  const auto share = [&bench](double s) { return milliseconds(value_at_share(bench.scan_s, s)); };
  std::string text =
      fmt::format("gdtslam {}\ncpu       {}, {}, {}\n", GDTSLAM_VERSION, device.name, to_string(backend.host_isa()),
                  job.options.loops_beside ? "one thread, loops beside it" : "one thread");
  const std::string name = log_name(job.log);
  text += fmt::format("{}: {} scans, {} of them keyframes, in {:.1f} s{}; {} came while the one before was at work\n",
                      name.substr(name.rfind('/') + 1), bench.scan_s.size(), bench.keyframes, bench.lasted_s,
                      job.speed > 0.0 ? fmt::format(", {:g} times as fast as recorded", job.speed) : "", bench.late);
  text +=
      fmt::format("scan ms   median {:.2f}, 90 % {:.2f}, 99 % {:.2f}, 99.9 % {:.2f}, largest {:.2f}; above 50 ms {}\n",
                  share(0.5), share(0.9), share(0.99), share(0.999), milliseconds(worst.all_s), bench.above_50_ms);
  text += fmt::format(
      "largest   scan {}{}: match {:.2f} ms, local field {:.2f} ms, merge {:.2f} ms, waited {:.2f} ms for loops\n",
      worst.index, worst.is_keyframe ? ", a keyframe" : "", milliseconds(worst.stages.match_s),
      milliseconds(worst.stages.local_field_s), milliseconds(worst.stages.merge_s), milliseconds(worst.waited_s));
  text += fmt::format("loops     {} places, {} corrections; waited {} times, {:.3f} s; {:.1f} s of CPU time beside\n",
                      bench.loops.places, bench.loops.corrections, bench.loops.waits, bench.loops.waited_s,
                      bench.loops.beside_cpu_s);
  return text;
}

std::string live_json(const LiveBenchJob& job, LiveBench& bench, const Backend& backend) {
  const LiveScan& worst = bench.largest;
  const std::string name = log_name(job.log);
  const nlohmann::ordered_json report{{"version", GDTSLAM_VERSION},
                                      {"device", backend.device().name},
                                      {"isa", to_string(backend.host_isa())},
                                      {"log", name.substr(name.rfind('/') + 1)},
                                      {"speed", job.speed},
                                      {"loops_beside", job.options.loops_beside},
                                      {"scans", bench.scan_s.size()},
                                      {"keyframes", bench.keyframes},
                                      {"late", bench.late},
                                      {"lasted_s", bench.lasted_s},
                                      {"busy_s", bench.busy_s},
                                      {"median_s", value_at_share(bench.scan_s, 0.5)},
                                      {"p90_s", value_at_share(bench.scan_s, 0.9)},
                                      {"p99_s", value_at_share(bench.scan_s, 0.99)},
                                      {"p999_s", value_at_share(bench.scan_s, 0.999)},
                                      {"above_50_ms", bench.above_50_ms},
                                      {"largest",
                                       {{"scan", worst.index},
                                        {"keyframe", worst.is_keyframe},
                                        {"all_s", worst.all_s},
                                        {"match_s", worst.stages.match_s},
                                        {"local_field_s", worst.stages.local_field_s},
                                        {"merge_s", worst.stages.merge_s},
                                        {"waited_s", worst.waited_s}}},
                                      {"loops",
                                       {{"places", bench.loops.places},
                                        {"corrections", bench.loops.corrections},
                                        {"waits", bench.loops.waits},
                                        {"waited_s", bench.loops.waited_s},
                                        {"beside_cpu_s", bench.loops.beside_cpu_s}}}};
  return json_text(report);
}

}  // namespace

std::string bench_live(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop, bool is_json) {
  LiveBench bench = LiveBenchRun(job, backend, stop).run();
  return is_json ? live_json(job, bench, backend) : live_text(job, bench, backend);
}

}  // namespace gdtslam
