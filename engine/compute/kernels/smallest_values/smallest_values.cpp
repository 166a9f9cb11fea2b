#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"

namespace gdtslam {
namespace {

struct Adapter {
  static constexpr std::string_view kName = "smallest_values";
  static constexpr std::string_view kWorkUnit = "value";
  static constexpr std::string_view kSource = "arg min of paper equation (4), the best few";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.smallest_values(params_of<SmallestValues::Params>(launch.params), buffer_of<std::uint32_t>(launch, 0),
                              buffer_of<std::uint32_t>(launch, 1));
  }
  static void check(const SmallestValues::Params& params, const LaunchCheck& check) {
    check.require(params.wanted >= 1 && params.wanted <= SmallestValues::kMost, "wanted must be 1 to 16");
    check.buffer(0, std::size_t{params.count} * 4);
    check.buffer(1, std::size_t{params.wanted} * 8);
    check.extent({1, 1, 1});
  }
  static std::uint64_t work(const SmallestValues::Params& params, Extent) { return params.count; }
};

}  // namespace

const KernelInfo& SmallestValues::info() {
  static const KernelInfo row = kernel_info<SmallestValues, Adapter>();
  return row;
}

}  // namespace gdtslam
