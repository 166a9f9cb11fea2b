#include <algorithm>
#include <cstring>

#include "bench_rows.hpp"
#include "gdtslam/compute/kernel_cases.hpp"

namespace gdtslam {
namespace {

/// Bytes of a case that are read plus those that are written.
std::size_t traffic_bytes(const KernelCase& kernel_case) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < kernel_case.buffers.size(); ++i) {
    const std::size_t size = kernel_case.buffers[i].content.size();
    bytes += kernel_case.kernel->bindings[i] == Access::kReadWrite ? 2 * size : size;
  }
  return bytes;
}

/// CPU seconds of memcpy for so many bytes read and written together.
double copy_s(std::size_t traffic, const TimingOptions& options) {
  const std::vector<std::byte> from(std::max<std::size_t>(traffic / 2, 1), std::byte{1});
  std::vector<std::byte> to(from.size());
  const auto copy = [&] {
    std::memcpy(to.data(), from.data(), from.size());
    asm volatile("" : : "r"(to.data()) : "memory");  // the copy is for its own sake
  };
  return measure(copy, options).cpu_s;
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
  std::byte last{};
  const auto dispatch = [&] {
    backend.dispatch(*kernel_case.kernel, bound, kernel_case.params, kernel_case.threads);
    backend.download(buffers.back(), std::span(&last, 1));  // waits for the dispatch
  };
  BenchRow row;
  row.group = "kernel";
  row.name = kernel_case.kernel->name;
  row.variant = kernel_case.name;
  row.unit = kernel_case.kernel->work_unit;
  row.work = static_cast<double>(kernel_case.kernel->work({sizes, kernel_case.params, kernel_case.threads}));
  row.timing = measure(dispatch, options);
  if (row.unit != "look-up") {  // look-ups are bound by latency: bytes do not describe them
    row.copy_ratio = copy_s(traffic_bytes(kernel_case), options) / row.timing.cpu_s;
  }
  return row;
}

}  // namespace

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
