#include "rows.hpp"

#include <array>
#include <exception>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// Dispatches in one submission of a device: enough to hide its cost, few enough for the memory that they keep.
constexpr int kMostInLine = 64;

std::exception_ptr first_error;

void measure_guarded(benchmark::State& state, const std::function<void(benchmark::State&)>& measure) {
  if (interrupted()) {
    state.SkipWithError("interrupted");
    return;
  }
  try {
    measure(state);
  } catch (const std::exception& error) {
    if (!first_error) first_error = std::current_exception();
    state.SkipWithError(error.what());
  }
}

}  // namespace

benchmark::internal::Benchmark* add_row(const BenchTarget& target, std::string_view group, std::string_view name,
                                        std::string_view variant, std::function<void(benchmark::State&)> measure) {
  std::string full = target.on;
  for (const std::string_view part : {group, name, variant}) full.append("/").append(part);
  benchmark::internal::Benchmark* const row = benchmark::RegisterBenchmark(
      full.c_str(), [measure = std::move(measure)](benchmark::State& state) { measure_guarded(state, measure); });
  row->Unit(benchmark::kMicrosecond)->MeasureProcessCPUTime();
  const std::string kind = target.backend.device().kind;
  if (kind != "cpu" && kind != "lavapipe") row->UseRealTime();  // CPU time is measured if a CPU does the work
  return row;
}

void rethrow_bench_error() {
  if (first_error) std::rethrow_exception(first_error);
}

std::function<double()> device_clock(Backend& backend) {
  const auto* const vulkan = dynamic_cast<const VulkanBackend*>(&backend);
  if (vulkan == nullptr || !(vulkan->vulkan_device().timestamp_ns > 0.0)) return nullptr;
  return [vulkan, before = vulkan->submit_count()]() mutable {
    const std::uint64_t submissions = std::exchange(before, vulkan->submit_count());
    return vulkan->submit_count() == submissions + 1 ? vulkan->last_submission_ns() : -1.0;
  };
}

Work work_on(Backend& backend, const Buffer& last, std::function<void()> step) {
  if (backend.device().kind == "cpu") return {.step = std::move(step)};
  Work work{.step = std::move(step), .in_line = kMostInLine};
  work.wait = [&backend, &last] {
    std::array<std::byte, 4> word{};
    backend.download(last, std::span(word).first(std::min(word.size(), last.bytes())));
  };
  work.device_ns = device_clock(backend);
  return work;
}

void time_work(benchmark::State& state, const Work& work, double units, std::string_view unit) {
  double device_ns = 0.0;
  bool has_device_ns = static_cast<bool>(work.device_ns);
  while (state.KeepRunningBatch(work.in_line)) {
    for (int k = 0; k < work.in_line; ++k) work.step();
    if (work.wait) work.wait();
    if (!work.device_ns) continue;
    const double ns = work.device_ns();
    has_device_ns = has_device_ns && ns >= 0.0;
    device_ns += ns;
  }
  const auto steps = static_cast<double>(state.iterations());
  if (has_device_ns) state.counters["device_s"] = 1e-9 * device_ns / steps;
  state.SetItemsProcessed(static_cast<std::int64_t>(steps * units));
  state.SetLabel(std::string(unit));
}

}  // namespace gdtslam
