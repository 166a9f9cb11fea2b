#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/interrupt.hpp"

namespace gdtslam {
namespace {

constexpr int kMostRepeats = 1 << 20;

/// Seconds for one step.
struct Sample {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  double device_s = -1.0;  // negative: unknown
};

Sample take_sample(const Work& work, int repeats) {
  Sample sample;
  double device_ns = 0.0;
  bool has_device_ns = static_cast<bool>(work.device_ns);
  Stopwatch watch;
  for (int done = 0; done < repeats;) {
    const int end = std::min(repeats, done + work.most_in_line);
    for (; done < end; ++done) work.step();
    if (work.wait) work.wait();
    if (!work.device_ns) continue;
    const double ns = work.device_ns();
    has_device_ns = has_device_ns && ns >= 0.0;
    device_ns += ns;
  }
  watch.add_to(sample.wall_s, sample.cpu_s);
  if (has_device_ns) sample.device_s = device_ns * 1e-9 / repeats;
  sample.wall_s /= repeats;
  sample.cpu_s /= repeats;
  return sample;
}

/// Repeats that fill a sample; the trials warm caches and pages up.
int repeats_for(const Work& work, double sample_s) {
  int repeats = 1;
  while (repeats < kMostRepeats && take_sample(work, repeats).wall_s * repeats < sample_s) repeats *= 2;
  return repeats;
}

double median(const std::vector<Sample>& samples, double Sample::*time) {
  std::vector<double> times;
  for (const Sample& sample : samples) times.push_back(sample.*time);
  return value_at_share(times, 0.5);
}

}  // namespace

Timing measure(const Work& work, const TimingOptions& options) {
  const int repeats = repeats_for(work, options.sample_s);
  const auto start = std::chrono::steady_clock::now();
  std::vector<Sample> samples;
  for (int i = 0; i < options.samples; ++i) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
    if (i >= TimingOptions::kFewestSamples &&
        std::chrono::steady_clock::now() - start > std::chrono::duration<double>(options.longest_s))
      break;
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

BenchRow measured_row(std::string_view group, std::string_view name, std::string_view variant, std::string_view unit,
                      double work, const Work& timed, const TimingOptions& options) {
  return {.group = std::string(group),
          .name = std::string(name),
          .variant = std::string(variant),
          .unit = std::string(unit),
          .work = work,
          .timing = measure(timed, options),
          .copy_ratio = {},
          .times_opencv = {},
          .different = {}};
}

}  // namespace gdtslam
