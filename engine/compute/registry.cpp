// The rows of all kernels and the names of instruction sets. A kernel missing in the list of cpu/functions.hpp does not
// exist for the tests, the benchmark and verify; the completeness test compares the list with the headers in kernels/.
#include <algorithm>
#include <array>

#include "engine/compute/cpu/functions.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {
namespace {

template <class... K>
std::array<const KernelInfo*, sizeof...(K)> kernel_rows(KernelList<K...> /*kernels*/) {
  return {&K::info()...};
}

}  // namespace

std::string_view to_string(Isa isa) {
  switch (isa) {
    case Isa::kBaseline:
      return "baseline";
    case Isa::kAvx2:
      return "avx2";
    case Isa::kAvx512:
      return "avx512";
  }
  return "unknown";
}

std::span<const KernelInfo* const> kernel_registry() {
  static const std::array kernels = kernel_rows(AllKernels{});
  return kernels;
}

const KernelInfo* find_kernel(std::string_view name) {
  const auto all = kernel_registry();
  const auto found = std::find_if(all.begin(), all.end(), [name](const KernelInfo* k) { return k->name == name; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace gdtslam
