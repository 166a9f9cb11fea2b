#include "timing.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/interrupt.hpp"

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

/// Seconds for one step.
struct Sample {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  double device_s = -1.0;  // negative: unknown
};

Sample take_sample(const Work& work, int repeats) {
  double device_ns = 0.0;
  bool has_device_ns = static_cast<bool>(work.device_ns);
  const double wall_start = wall_now_s();
  const double cpu_start = cpu_now_s();
  for (int done = 0; done < repeats;) {
    const int end = std::min(repeats, done + work.most_in_line);
    for (; done < end; ++done) work.step();
    if (work.wait) work.wait();
    if (!work.device_ns) continue;
    const double ns = work.device_ns();
    has_device_ns = has_device_ns && ns >= 0.0;
    device_ns += ns;
  }
  return {(wall_now_s() - wall_start) / repeats, (cpu_now_s() - cpu_start) / repeats,
          has_device_ns ? device_ns * 1e-9 / repeats : -1.0};
}

/// Repeats that fill a sample; the trials warm caches and pages up.
int repeats_for(const Work& work, double sample_s) {
  int repeats = 1;
  while (repeats < kMostRepeats && take_sample(work, repeats).wall_s * repeats < sample_s) repeats *= 2;
  return repeats;
}

double median(std::vector<Sample> samples, double Sample::*time) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end(),
                   [time](const Sample& a, const Sample& b) { return a.*time < b.*time; });
  return (*middle).*time;
}

}  // namespace

Timing measure(const Work& work, const TimingOptions& options) {
  const int repeats = repeats_for(work, options.sample_s);
  const double start_s = wall_now_s();
  std::vector<Sample> samples;
  for (int i = 0; i < options.samples; ++i) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
    if (i >= TimingOptions::kFewestSamples && wall_now_s() - start_s > options.longest_s) break;
    samples.push_back(take_sample(work, repeats));
  }
  const auto [fastest, slowest] = std::minmax_element(
      samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.cpu_s < b.cpu_s; });
  Timing timing{
      median(samples, &Sample::wall_s), median(samples, &Sample::cpu_s), fastest->cpu_s, slowest->cpu_s, std::nullopt,
      static_cast<int>(samples.size())};
  const double device_s = median(samples, &Sample::device_s);
  if (device_s > 0.0) timing.device_s = device_s;
  return timing;
}

}  // namespace gdtslam
