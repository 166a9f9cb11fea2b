#include <algorithm>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

/// Bytes that a case reads and writes.
std::size_t traffic_bytes(const KernelCase& kernel_case) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < kernel_case.buffers.size(); ++i) {
    const std::size_t size = kernel_case.buffers[i].content.size();
    bytes += kernel_case.kernel->bindings[i] == Access::kReadWrite ? 2 * size : size;
  }
  return bytes;
}

/// Whether the work covers most of the largest buffer; else its bytes do not measure the work.
bool touches_most(const KernelCase& kernel_case, double work) {
  double values = 0.0;
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    values = std::max(values, static_cast<double>(buffer.layout.width) * buffer.layout.height);
  }
  return work >= 0.25 * values;
}

void measure_case(benchmark::State& state, Backend& backend, const KernelCase& kernel_case) {
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
  const KernelInfo& kernel = *kernel_case.kernel;
  const auto dispatch = [&] { backend.dispatch(kernel, bound, kernel_case.params, kernel_case.threads); };
  const auto work = static_cast<double>(kernel.work({sizes, kernel_case.params, kernel_case.threads}));
  time_work(state, work_on(backend, buffers.back(), dispatch), work, kernel.work_unit);
  if (kernel.work_unit != "look-up" && touches_most(kernel_case, work)) {  // look-ups are bound by latency
    state.counters["bytes"] = static_cast<double>(traffic_bytes(kernel_case));
  }
}

}  // namespace

void add_kernels(const BenchTarget& target) {
  for (const KernelCaseSource& source : kernel_cases()) {
    if (!source.benchmark) continue;
    add_row(target, "kernel", source.kernel->name, source.name,
            [make = source.make, &backend = target.backend](benchmark::State& state) {
              measure_case(state, backend, make());
            });
  }
}

}  // namespace gdtslam
