// How times are taken, what they are held against, and the kernels on the benchmark cases of the shared list.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/core/quantile.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// Dispatches in one submission of a device: enough to hide what a submission costs, few enough for its memory of them.
constexpr int kMostInLine = 64;

/// Bytes of a case that are read plus those that are written.
std::size_t traffic_bytes(const KernelCase& kernel_case) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < kernel_case.buffers.size(); ++i) {
    const std::size_t size = kernel_case.buffers[i].content.size();
    bytes += kernel_case.kernel->bindings[i] == Access::kReadWrite ? 2 * size : size;
  }
  return bytes;
}

/// Whether the work covers a good part of the largest buffer; else its bytes say nothing of the work.
bool touches_most(const KernelCase& kernel_case, double work) {
  double values = 0.0;
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    values = std::max(values, static_cast<double>(buffer.layout.width) * buffer.layout.height);
  }
  return work >= 0.25 * values;
}

Work copy_work(const std::vector<std::byte>& from, std::vector<std::byte>& to) {
  return {.step = [&from, &to] {
    std::memcpy(to.data(), from.data(), from.size());
    asm volatile("" : : "r"(to.data()) : "memory");  // the copy is for its own sake
  }};
}

Timing memcpy_timing(std::size_t bytes, const TimingOptions& options) {
  const std::vector<std::byte> from(bytes, std::byte{1});
  std::vector<std::byte> to(from.size());
  return measure(copy_work(from, to), options);
}

Timing device_copy_timing(VulkanBackend& device, std::size_t bytes, const TimingOptions& options) {
  const Buffer from = device.allocate(bytes);
  const Buffer to = device.allocate(bytes);
  return measure(work_on(device, to, [&] { device.copy(from, to); }), options);
}

BenchRow bench_case(Backend& backend, const KernelCase& kernel_case, const TimingOptions& options) {
  std::vector<Buffer> buffers;
  std::vector<const Buffer*> bound;
  std::vector<std::size_t> sizes;
  buffers.reserve(kernel_case.buffers.size());
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    buffers.push_back(backend.allocate(buffer.content.size()));
    backend.upload(buffers.back(), buffer.content);
    bound.push_back(&buffers.back());
    sizes.push_back(buffer.content.size());
  }
  const auto dispatch = [&] { backend.dispatch(*kernel_case.kernel, bound, kernel_case.params, kernel_case.threads); };
  BenchRow row =
      measured_row("kernel", kernel_case.kernel->name, kernel_case.name, kernel_case.kernel->work_unit,
                   static_cast<double>(kernel_case.kernel->work({sizes, kernel_case.params, kernel_case.threads})),
                   work_on(backend, buffers.back(), dispatch), options);
  if (row.unit != "look-up" && touches_most(kernel_case, row.work)) {  // look-ups are bound by latency, not by bytes
    const Timing copy = copy_timing(backend, traffic_bytes(kernel_case), options);
    const Basis basis = basis_of(row.timing, basis_of(copy, basis_of(backend)));  // one that both have
    row.copy_ratio = seconds_of(copy, basis) / seconds_of(row.timing, basis);
  }
  return row;
}

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

std::vector<double> times_of(const std::vector<Sample>& samples, double Sample::*time) {
  std::vector<double> times;
  times.reserve(samples.size());
  for (const Sample& sample : samples) times.push_back(sample.*time);
  return times;
}

double median(std::vector<double> times) { return upper_median(times); }

}  // namespace

Basis basis_of(const Backend& backend) {
  const std::string& kind = backend.device().kind;
  if (kind == "cpu" || kind == "lavapipe") return Basis::kCpu;
  const auto* const vulkan = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan != nullptr && vulkan->vulkan_device().timestamp_ns > 0.0 ? Basis::kDevice : Basis::kWall;
}

double seconds_of(const Timing& timing, Basis basis) {
  if (basis == Basis::kCpu) return timing.cpu_s;
  return basis == Basis::kDevice ? timing.device_s.value() : timing.wall_s;
}

std::size_t spreading_stride(std::size_t count) {
  std::size_t stride = count / 2 + 1;
  while (std::gcd(stride, count) != 1) ++stride;
  return stride;
}

std::function<double()> clock_of(Backend& backend) {
  const auto* const vulkan = dynamic_cast<const VulkanBackend*>(&backend);
  if (vulkan == nullptr || !(vulkan->vulkan_device().timestamp_ns > 0.0)) return nullptr;
  return [vulkan, before = vulkan->submit_count()]() mutable {
    const std::uint64_t submissions = std::exchange(before, vulkan->submit_count());
    return vulkan->submit_count() == submissions + 1 ? vulkan->last_submission_ns() : -1.0;
  };
}

Work work_on(Backend& backend, const Buffer& last, std::function<void()> step) {
  if (backend.device().kind == "cpu") return {.step = std::move(step)};
  Work work{.step = std::move(step), .most_in_line = kMostInLine};
  work.wait = [&backend, &last] {
    std::array<std::byte, 4> word{};
    backend.download(last, std::span(word).first(std::min(word.size(), last.bytes())));
  };
  work.device_ns = clock_of(backend);
  return work;
}

Timing copy_timing(Backend& backend, std::size_t traffic, const TimingOptions& options) {
  const std::size_t bytes = std::max<std::size_t>(traffic / 2, 1);
  auto* const vulkan = dynamic_cast<VulkanBackend*>(&backend);
  return vulkan != nullptr ? device_copy_timing(*vulkan, bytes, options) : memcpy_timing(bytes, options);
}

BenchRow copy_row(std::string_view variant, std::size_t bytes, const TimingOptions& options) {
  const std::vector<std::byte> from(bytes, std::byte{1});
  std::vector<std::byte> to(from.size());
  return measured_row("limit", "copy", variant, "byte", 2.0 * static_cast<double>(bytes), copy_work(from, to), options);
}

std::vector<BenchRow> bench_kernels(Backend& backend, std::string_view filter, const TimingOptions& options) {
  std::vector<BenchRow> rows;
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark && source.kernel->name.find(filter) != std::string_view::npos) {
      rows.push_back(bench_case(backend, source.make(), options));
    }
  }
  return rows;
}

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
  Timing timing;
  timing.samples = static_cast<int>(samples.size());
  timing.wall_samples_s = times_of(samples, &Sample::wall_s);
  timing.cpu_samples_s = times_of(samples, &Sample::cpu_s);
  timing.wall_s = median(timing.wall_samples_s);
  timing.cpu_s = median(timing.cpu_samples_s);
  const auto [fastest, slowest] = std::minmax_element(timing.cpu_samples_s.begin(), timing.cpu_samples_s.end());
  timing.fastest_s = *fastest;
  timing.slowest_s = *slowest;
  std::vector<double> device_s = times_of(samples, &Sample::device_s);
  if (std::all_of(device_s.begin(), device_s.end(), [](double seconds) { return seconds > 0.0; })) {
    timing.device_s = median(device_s);
    timing.device_samples_s = std::move(device_s);
  }
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
