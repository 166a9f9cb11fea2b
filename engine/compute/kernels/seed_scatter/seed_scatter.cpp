#include "seed_scatter.hpp"

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostOfSide = 65535;

}  // namespace

const KernelInfo& SeedScatter::info() {
  static const KernelInfo row = kernel_info<SeedScatter>(
      {"seed_scatter", "cell", "seeds of paper equation (1)"}, kCall<&IsaFunctions::seed_scatter>,
      [](const Params& params, Extent) -> std::uint64_t { return params.count; },
      [](const Params& params, const LaunchCheck& check) {
        check.grid(params.width, params.height, params.stride, kMostOfSide);
        check.buffer(0, std::size_t{params.count} * 4);
        check.buffer(1, grid_bytes(params.width, params.height, params.stride, 1));
        check.extent({params.count, 1, 1});
      });
  return row;
}

}  // namespace gdtslam
