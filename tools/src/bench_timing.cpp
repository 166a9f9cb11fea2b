#include "bench_timing.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "interrupt.hpp"

namespace gdtslam {
namespace {

constexpr int kMostRepeats = 1 << 20;

double cpu_now_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Sample {
  double wall_s;
  double cpu_s;
};

Sample take_sample(const std::function<void()>& work, int repeats) {
  const double wall_start = wall_now_s();
  const double cpu_start = cpu_now_s();
  for (int i = 0; i < repeats; ++i) work();
  return {(wall_now_s() - wall_start) / repeats, (cpu_now_s() - cpu_start) / repeats};
}

/// Repeats that fill a sample; the trials warm caches and pages up.
int repeats_for(const std::function<void()>& work, double sample_s) {
  int repeats = 1;
  while (repeats < kMostRepeats && take_sample(work, repeats).wall_s * repeats < sample_s) repeats *= 2;
  return repeats;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Timing measure(const std::function<void()>& work, const TimingOptions& options) {
  const int repeats = repeats_for(work, options.sample_s);
  std::vector<double> wall;
  std::vector<double> cpu;
  for (int i = 0; i < options.samples; ++i) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
    const Sample sample = take_sample(work, repeats);
    wall.push_back(sample.wall_s);
    cpu.push_back(sample.cpu_s);
  }
  const auto [fastest, slowest] = std::minmax_element(cpu.begin(), cpu.end());
  return {median(wall), median(cpu), *fastest, *slowest, options.samples};
}

}  // namespace gdtslam
