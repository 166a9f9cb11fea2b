#include "pose_lattice.hpp"

#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostLatticeSamples = 1U << 28U;
/// More samples a side exceed the limit even for a single angle, and their square could exceed 64 bits.
constexpr std::uint32_t kMostOfSide = 1U << 14U;

/// Samples of a window; refuses windows with none or too many.
std::uint32_t checked_samples(std::uint32_t count_xy, std::uint32_t count_theta, const LaunchCheck& check) {
  check.require(count_xy > 0 && count_theta > 0, "a window without samples");
  check.require(count_xy <= kMostOfSide && std::uint64_t{count_xy} * count_xy * count_theta <= kMostLatticeSamples,
                "more than 2^28 samples");
  return count_xy * count_xy * count_theta;
}

}  // namespace

const KernelInfo& PoseLattice::info() {
  static const KernelInfo row = kernel_info<PoseLattice>(
      {"pose_lattice", "value", "candidates of paper equation (4), a window of them"},
      kCall<&IsaFunctions::pose_lattice>, kThings, [](const Params& params, const LaunchCheck& check) {
        const std::uint32_t samples = checked_samples(params.count_xy, params.count_theta, check);
        check.require(std::isfinite(params.centre_x) && std::isfinite(params.centre_y) &&
                          std::isfinite(params.centre_theta) && std::isfinite(params.step_cells) &&
                          std::isfinite(params.step_rad),
                      "the window's centre or a step is not finite");
        check.prior(params.prior);
        check.buffer(0, samples * sizeof(PoseCandidate));
        check.extent({samples, 1, 1});
      });
  return row;
}
const KernelInfo& LatticeMinima::info() {
  static const KernelInfo row = kernel_info<LatticeMinima>(
      {"lattice_minima", "value", "local minima of paper equation (4) over a window"},
      kCall<&IsaFunctions::lattice_minima>, kThings, [](const Params& params, const LaunchCheck& check) {
        const std::uint32_t samples = checked_samples(params.count_xy, params.count_theta, check);
        check.buffer(0, samples * sizeof(std::uint32_t));
        check.buffer(1, samples * sizeof(std::uint32_t));
        check.extent({samples, 1, 1});
      });
  return row;
}
const KernelInfo& SmallestValues::info() {
  static const KernelInfo row = kernel_info<SmallestValues>(
      {"smallest_values", "value", "arg min of paper equation (4), the best few"},
      kCall<&IsaFunctions::smallest_values>, [](const Params& params, Extent) -> std::uint64_t { return params.count; },
      [](const Params& params, const LaunchCheck& check) {
        check.require(params.wanted >= 1 && params.wanted <= SmallestValues::kMost, "wanted must be 1 to 16");
        check.buffer(0, std::size_t{params.count} * 4);
        check.buffer(1, std::size_t{params.wanted} * 8);
        check.extent({1, 1, 1});
      });
  return row;
}

}  // namespace gdtslam
