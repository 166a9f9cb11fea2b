// Common code of the kernels' rows: typed views of a launch, the checks of its sizes, the call of a kernel's function
// with them, and the construction of the row.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "functions.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

/// True if the build has kernels for an instruction set.
constexpr bool is_compiled(Isa isa) {
#ifdef GDTSLAM_X86_KERNELS
  return isa == Isa::kBaseline || isa == Isa::kAvx2 || isa == Isa::kAvx512;
#else
  return isa == Isa::kBaseline;
#endif
}

/// The functions of an instruction set; the build must have it.
inline const IsaFunctions& isa_functions(Isa isa) {
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

// Count of calls of CPU kernels, by which `verify` proves that a device used none of them. Each thread counts in a word
// that only it writes: a call costs a load and a store, without a locked instruction.

/// This thread's word; null before its first call.
extern constinit thread_local std::atomic<std::uint64_t>* calls_of_this_thread;

/// Gives this thread a word.
std::atomic<std::uint64_t>& enlist_this_thread();

inline void count_kernel_call() {
  std::atomic<std::uint64_t>& calls = calls_of_this_thread != nullptr ? *calls_of_this_thread : enlist_this_thread();
  calls.store(calls.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

/// The parameters of a launch; their bytes need no alignment.
template <class Params>
Params read_params(std::span<const std::byte> bytes) {
  Params params;
  std::memcpy(&params, bytes.data(), sizeof(Params));
  return params;
}

/// A buffer of a launch as values; buffers are aligned to cache lines.
template <class T>
T* typed_buffer(const CpuLaunch& launch, std::size_t binding) {
  return reinterpret_cast<T*>(launch.buffers[binding].data());
}

/// The cells of a slice of a two-dimensional launch.
inline CellRange cell_range(const CpuLaunch& launch) {
  if (launch.threads.y > 1) {
    return {0, launch.threads.x, launch.begin, launch.end};
  }
  return {launch.begin, launch.end, 0, 1};
}

/// Argument number `place` of a kernel's function after its parameters: a buffer, or a size of the launch.
template <class T>
T launch_argument(const CpuLaunch& launch, std::size_t place) {
  if constexpr (std::is_pointer_v<T>) {
    return typed_buffer<std::remove_pointer_t<T>>(launch, place);
  } else if constexpr (std::is_same_v<T, CellRange>) {
    return cell_range(launch);
  } else {
    return Slice{launch.begin, launch.end};
  }
}

template <class Params, class... Arguments>
void call_function(void (*function)(const Params&, Arguments...), const CpuLaunch& launch) {
  [&]<std::size_t... kPlaces>(std::index_sequence<kPlaces...>) {
    function(read_params<Params>(launch.params), launch_argument<Arguments>(launch, kPlaces)...);
  }
  (std::index_sequence_for<Arguments...>{});
}

/// Turns a launch into a call of the kernel's function whose only arguments are the bindings.
template <auto kFunction>
inline constexpr auto kCall =
    [](const IsaFunctions& functions, const CpuLaunch& launch) { call_function(functions.*kFunction, launch); };

/// Scratch of this thread, at least `count` values, contents undefined. One per type: used by one kernel at a time.
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

/// Bytes that a grid of `height` rows needs at least: the last row needs no padding.
std::size_t grid_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::size_t cell_bytes);
/// Bytes that a field of such a layout needs at least.
std::size_t field_bytes(const FieldLayout& layout, std::uint32_t width, std::uint32_t height);

/// Checks of one launch; each throws Error.
class LaunchCheck {
 public:
  LaunchCheck(std::string_view kernel, const LaunchShape& shape) : kernel_(kernel), shape_(shape) {}
  /// Checks that the grid is at most `limit` cells wide and high, that rows do not overlap and the stride is a multiple
  /// of 4, or that the grid is empty.
  void grid(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::uint32_t limit) const;
  /// Checks that the field is at most `limit` cells wide and high, or empty, that rows and strips do not overlap,
  /// strides are multiples of 4, cells at most 2^32, and the blank has 16 bits.
  void layout(const FieldLayout& layout, std::uint32_t width, std::uint32_t height, std::uint32_t limit) const;
  void buffer(std::size_t binding, std::size_t bytes) const;
  void extent(Extent wanted) const;
  [[nodiscard]] Extent threads() const { return shape_.threads; }
  /// Checks the conditions of PriorParams, and that means are finite.
  void prior(const PriorParams& prior) const;
  /// The limits of PoseCost, whose field is buffer 0 and whose points are buffer 1.
  void cost(const PoseCost::Params& params) const;
  void require(bool condition, const char* message) const;

 private:
  std::string_view kernel_;
  const LaunchShape& shape_;
};

/// For grids without their own limit.
inline constexpr std::uint32_t kNoLimit = 0x7FFFFFFFU;

/// The functions of an instruction set for a direct call, which is counted; throws UnavailableError if the build has
/// none.
const IsaFunctions& functions_or_throw(Isa isa);

/// The call for an instruction set, or nullptr if the build has none.
template <class Call>
constexpr std::array<CpuFunction, kIsaCount> per_isa() {
  constexpr auto function = []<Isa isa>() -> CpuFunction {
    if constexpr (!is_compiled(isa)) {
      return nullptr;
    } else {
      return +[](const CpuLaunch& launch) {
        count_kernel_call();
        Call{}(isa_functions(isa), launch);
      };
    }
  };
  return {function.template operator()<Isa::kBaseline>(), function.template operator()<Isa::kAvx2>(),
          function.template operator()<Isa::kAvx512>()};
}

/// Elementary steps of launches with equal work for each cell of a grid, or for each item along x.
inline constexpr auto kCells = [](const auto& params, Extent /*threads*/) {
  return std::uint64_t{params.width} * params.height;
};
inline constexpr auto kThings = [](const auto& /*params*/, Extent threads) { return std::uint64_t{threads.x}; };

/// Texts about a kernel in the registry.
struct KernelText {
  std::string_view name;
  std::string_view work_unit;
  std::string_view source;
};

/// The registry's row of kernel K. `call` turns a launch into a call (kCall), `work` counts its elementary steps and
/// `check` throws if sizes do not fit; none of the three captures anything.
template <class K, class Call, class Work, class Check>
KernelInfo kernel_info(const KernelText& text, Call /*call*/, Work /*work*/, Check /*check*/) {
  KernelInfo info;
  info.name = text.name;
  info.bindings = K::kBindings;
  info.params_bytes = sizeof(typename K::Params);
  info.cpu = per_isa<Call>();
  info.check = [](const LaunchShape& shape) {
    Check{}(read_params<typename K::Params>(shape.params), LaunchCheck(K::info().name, shape));
  };
  info.work = [](const LaunchShape& shape) {
    return Work{}(read_params<typename K::Params>(shape.params), shape.threads);
  };
  info.work_unit = text.work_unit;
  info.source = text.source;
  return info;
}

}  // namespace gdtslam
