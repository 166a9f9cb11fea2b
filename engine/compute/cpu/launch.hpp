// What the kernels' adapters share: typed views of a launch, the checks of its sizes, and the rows of the registry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "functions.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "kernel_calls.hpp"

namespace gdtslam {

/// Whether the build has kernels for an instruction set.
constexpr bool is_compiled(Isa isa) {
#ifdef GDTSLAM_X86_KERNELS
  return isa == Isa::kBaseline || isa == Isa::kAvx2 || isa == Isa::kAvx512;
#else
  return isa == Isa::kBaseline;
#endif
}

/// The functions of an instruction set that the build has.
inline const IsaFunctions& functions_of(Isa isa) {
#ifdef GDTSLAM_X86_KERNELS
  if (isa == Isa::kAvx2) {
    return kAvx2Functions;
  }
  if (isa == Isa::kAvx512) {
    return kAvx512Functions;
  }
#endif
  return kBaselineFunctions;
}

/// The parameters of a launch; their bytes need no alignment.
template <class Params>
Params params_of(std::span<const std::byte> bytes) {
  Params params;
  std::memcpy(&params, bytes.data(), sizeof(Params));
  return params;
}

/// A buffer of a launch as values; buffers are aligned to cache lines.
template <class T>
T* buffer_of(const CpuLaunch& launch, std::size_t binding) {
  return reinterpret_cast<T*>(launch.buffers[binding].data());
}

/// The cells of a slice of a two-dimensional launch.
inline CellRange cell_range(const CpuLaunch& launch) {
  if (launch.threads.y > 1) {
    return {0, launch.threads.x, launch.begin, launch.end};
  }
  return {launch.begin, launch.end, 0, 1};
}

/// Scratch of this thread, at least `count` values, contents undefined. One per type: a kernel uses it to its end.
template <class T>
T* thread_scratch(std::size_t count) {
  thread_local std::vector<T> scratch;
  if (scratch.size() < count) {
    scratch.resize(count);
  }
  return scratch.data();
}

/// Throws Error "kernel NAME: MESSAGE".
[[noreturn]] void refuse_launch(std::string_view kernel, const std::string& message);

/// Bytes that a grid of `height` rows touches at least: the last row needs no padding.
std::size_t grid_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::size_t cell_bytes);

/// Checks of one launch; each throws Error.
class LaunchCheck {
 public:
  LaunchCheck(std::string_view kernel, const LaunchShape& shape) : kernel_(kernel), shape_(shape) {}
  /// At least 1 and at most `limit` cells wide and high, rows that do not overlap, a stride that is a multiple of 4.
  void grid(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::uint32_t limit) const;
  void buffer(std::size_t binding, std::size_t bytes) const;
  void extent(Extent wanted) const;
  [[nodiscard]] Extent threads() const { return shape_.threads; }
  /// What PriorParams promises, finite means besides.
  void prior(const PriorParams& prior) const;
  void require(bool condition, const char* message) const;

 private:
  std::string_view kernel_;
  const LaunchShape& shape_;
};

/// Grids without a limit of their own.
inline constexpr std::uint32_t kNoLimit = 0x7FFFFFFFU;

/// The functions of an instruction set for a direct call, which is counted; throws UnavailableError where the build has
/// none.
const IsaFunctions& functions_or_throw(Isa isa);

/// The adapter of an instruction set, or nullptr where the build has none. `Adapter` turns a launch into a call.
template <class Adapter>
constexpr std::array<CpuFunction, kIsaCount> per_isa() {
  constexpr auto function = []<Isa isa>() -> CpuFunction {
    if constexpr (!is_compiled(isa)) {
      return nullptr;
    } else {
      return +[](const CpuLaunch& launch) {
        count_kernel_call();
        Adapter::call(functions_of(isa), launch);
      };
    }
  };
  return {function.template operator()<Isa::kBaseline>(), function.template operator()<Isa::kAvx2>(),
          function.template operator()<Isa::kAvx512>()};
}

/// The registry's row of kernel K, whose adapter has name, source, unit, call, check and work.
template <class K, class Adapter>
KernelInfo kernel_info() {
  KernelInfo info;
  info.name = Adapter::kName;
  info.bindings = K::kBindings;
  info.params_bytes = sizeof(typename K::Params);
  info.cpu = per_isa<Adapter>();
  info.check = [](const LaunchShape& shape) {
    Adapter::check(params_of<typename K::Params>(shape.params), LaunchCheck(Adapter::kName, shape));
  };
  info.work = [](const LaunchShape& shape) {
    return Adapter::work(params_of<typename K::Params>(shape.params), shape.threads);
  };
  info.work_unit = Adapter::kWorkUnit;
  info.source = Adapter::kSource;
  return info;
}

}  // namespace gdtslam
