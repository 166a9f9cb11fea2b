#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "engine/compute/cases/kernel_cases.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "rows.hpp"

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

Timing memcpy_timing(std::size_t bytes, const TimingOptions& options) {
  const std::vector<std::byte> from(bytes, std::byte{1});
  std::vector<std::byte> to(from.size());
  const auto copy = [&] {
    std::memcpy(to.data(), from.data(), from.size());
    asm volatile("" : : "r"(to.data()) : "memory");  // the copy is for its own sake
  };
  return measure({.step = copy}, options);
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
    row.copy_ratio =
        copy_seconds(backend, traffic_bytes(kernel_case), options) / seconds_of(row.timing, basis_of(backend));
  }
  return row;
}

}  // namespace

Basis basis_of(const Backend& backend) {
  const std::string& kind = backend.device().kind;
  if (kind == "cpu" || kind == "lavapipe") return Basis::kCpu;
  const auto* const vulkan = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan != nullptr && vulkan->vulkan_device().timestamp_ns > 0.0 ? Basis::kDevice : Basis::kWall;
}

double seconds_of(const Timing& timing, Basis basis) {
  if (basis == Basis::kCpu) return timing.cpu_s;
  return basis == Basis::kDevice ? timing.device_s.value_or(timing.wall_s) : timing.wall_s;
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

double copy_seconds(Backend& backend, std::size_t traffic, const TimingOptions& options) {
  const std::size_t bytes = std::max<std::size_t>(traffic / 2, 1);
  auto* const vulkan = dynamic_cast<VulkanBackend*>(&backend);
  const Timing timing = vulkan != nullptr ? device_copy_timing(*vulkan, bytes, options) : memcpy_timing(bytes, options);
  return seconds_of(timing, basis_of(backend));
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

}  // namespace gdtslam
