#include "seed_scatter.hpp"

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostOfSide = 65535;

struct Adapter {
  static constexpr std::string_view kName = "seed_scatter";
  static constexpr std::string_view kWorkUnit = "cell";
  static constexpr std::string_view kSource = "seeds of paper equation (1)";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.seed_scatter(params_of<SeedScatter::Params>(launch.params), buffer_of<std::uint32_t>(launch, 0),
                           buffer_of<std::uint8_t>(launch, 1), launch.begin, launch.end);
  }
  static void check(const SeedScatter::Params& params, const LaunchCheck& check) {
    check.grid(params.width, params.height, params.stride, kMostOfSide);
    check.buffer(0, std::size_t{params.count} * 4);
    check.buffer(1, grid_bytes(params.width, params.height, params.stride, 1));
    check.extent({params.count, 1, 1});
  }
  static std::uint64_t work(const SeedScatter::Params& params, Extent) { return params.count; }
};

}  // namespace

const KernelInfo& SeedScatter::info() {
  static const KernelInfo row = kernel_info<SeedScatter, Adapter>();
  return row;
}

}  // namespace gdtslam
