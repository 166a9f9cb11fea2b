#include "live.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <thread>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using LiveClock = std::chrono::steady_clock;

constexpr double kLongestPause_s = 10.0;  // between two scans, by their stamps: robots stand at night
constexpr auto kNap = std::chrono::milliseconds(50);

double seconds_since(LiveClock::time_point start) {
  return std::chrono::duration<double>(LiveClock::now() - start).count();
}

double cpu_of_this_thread_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1.0e-9 * static_cast<double>(time.tv_nsec);
}

std::uint64_t most_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<std::uint64_t>(usage.ru_maxrss);
}

StageTimes less(const StageTimes& a, const StageTimes& b) {
  return {a.predict_s - b.predict_s, a.match_s - b.match_s, a.local_field_s - b.local_field_s, a.merge_s - b.merge_s};
}

/// A mapper with loops or without.
class LiveMapper {
 public:
  LiveMapper(const LiveBenchJob& job, Backend& backend) {
    if (job.loops) {
      loops_.emplace(job.mapper, backend, job.options);
    } else {
      alone_.emplace(job.mapper, backend, job.options);
    }
  }
  MatchResult process(const ScanRecord& record) {
    if (alone_) return alone_->process(record.scan, record.T_odom_base);
    loops_->start(record.scan, record.T_odom_base);
    return loops_->finish();
  }
  [[nodiscard]] MapperStatistics statistics() const {
    return alone_ ? alone_->statistics() : loops_->front_end().statistics();
  }
  [[nodiscard]] LiveStatistics loops() const { return loops_ ? loops_->live_statistics() : LiveStatistics{}; }

 private:
  std::optional<LoopMapper> loops_;
  std::optional<Mapper> alone_;
};

class LiveBenchRun {
 public:
  LiveBenchRun(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop)
      : job_(job), stop_(stop), mapper_(job, backend) {}

  LiveBench run() {
    ScanStream scans({job_.log}, job_.read, {});
    const LiveClock::time_point start = LiveClock::now();
    while (const std::optional<ScanRecord> record = scans.next()) {
      wait_for(record->scan.stamp_s);
      take(*record);
    }
    if (bench_.scans.empty()) throw InputError(FilePosition{log_name(job_.log), 0}, "holds no laser scan");
    bench_.lasted_s = seconds_since(start);
    bench_.loops = mapper_.loops();
    bench_.keyframes = mapper_.statistics().keyframes;
    bench_.peak_bytes = most_memory_bytes();
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
    const MapperStatistics before = mapper_.statistics();
    const double waited_s = mapper_.loops().waited_s;
    LiveScan scan{.index = bench_.scans.size()};
    const double cpu_s = cpu_of_this_thread_s();
    const LiveClock::time_point start = LiveClock::now();
    scan.is_keyframe = mapper_.process(record).merged;
    done_ = LiveClock::now();
    scan.all_s = std::chrono::duration<double>(done_ - start).count();
    scan.cpu_s = cpu_of_this_thread_s() - cpu_s;
    const MapperStatistics after = mapper_.statistics();
    scan.waited_s = mapper_.loops().waited_s - waited_s;
    scan.stages = less(after.stages, before.stages);
    scan.windows = after.attempts - before.attempts;
    scan.evaluations = after.evaluations - before.evaluations;
    bench_.scans.push_back(scan);
  }

  const LiveBenchJob& job_;
  std::function<bool()> stop_;
  LiveMapper mapper_;
  LiveBench bench_;
  LiveClock::time_point due_ = LiveClock::now();
  LiveClock::time_point done_ = due_;  // the scan before
  std::optional<double> last_stamp_s_;
};

}  // namespace

LiveBench run_live(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop) {
  return LiveBenchRun(job, backend, stop).run();
}

std::vector<LivePart> live_parts(const std::vector<LiveScan>& scans, std::size_t pieces) {
  const std::size_t length = std::max<std::size_t>(1, (scans.size() + pieces - 1) / pieces);
  std::vector<LivePart> parts((scans.size() + length - 1) / length);
  for (const LiveScan& scan : scans) {
    LivePart& part = parts[scan.index / length];
    if (part.scans++ == 0) part.first = scan.index;
    if (!scan.is_keyframe) {
      part.scan_cpu_s += scan.cpu_s;
      continue;
    }
    ++part.keyframes;
    part.keyframe_cpu_s += scan.cpu_s;
    part.keyframe_merge_s += scan.stages.local_field_s + scan.stages.merge_s;
  }
  for (LivePart& part : parts) {
    const auto others = static_cast<double>(std::max<std::size_t>(1, part.scans - part.keyframes));
    const auto keyframes = static_cast<double>(std::max<std::size_t>(1, part.keyframes));
    part.scan_cpu_s /= others;
    part.keyframe_cpu_s /= keyframes;
    part.keyframe_merge_s /= keyframes;
  }
  return parts;
}

}  // namespace gdtslam
