#include "pose_lattice.hpp"

#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostSamples = 1U << 28U;
/// More samples a side exceed the limit on the first row of angles alone, and their square could leave 64 bits.
constexpr std::uint32_t kMostOfSide = 1U << 14U;

/// Samples of a window; refuses windows without any and those of too many.
std::uint32_t checked_samples(std::uint32_t count_xy, std::uint32_t count_theta, const LaunchCheck& check) {
  check.require(count_xy > 0 && count_theta > 0, "a window without samples");
  check.require(count_xy <= kMostOfSide && std::uint64_t{count_xy} * count_xy * count_theta <= kMostSamples,
                "more than 2^28 samples");
  return count_xy * count_xy * count_theta;
}

struct LatticeAdapter {
  static constexpr std::string_view kName = "pose_lattice";
  static constexpr std::string_view kWorkUnit = "value";
  static constexpr std::string_view kSource = "candidates of paper equation (4), a window of them";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.pose_lattice(params_of<PoseLattice::Params>(launch.params), buffer_of<PoseCandidate>(launch, 0),
                           launch.begin, launch.end);
  }
  static void check(const PoseLattice::Params& params, const LaunchCheck& check) {
    const std::uint32_t samples = checked_samples(params.count_xy, params.count_theta, check);
    check.require(std::isfinite(params.centre_x) && std::isfinite(params.centre_y) &&
                      std::isfinite(params.centre_theta) && std::isfinite(params.step_cells) &&
                      std::isfinite(params.step_rad),
                  "the window's centre or a step is not finite");
    check.prior(params.prior);
    check.buffer(0, samples * sizeof(PoseCandidate));
    check.extent({samples, 1, 1});
  }
  static std::uint64_t work(const PoseLattice::Params&, Extent threads) { return threads.x; }
};

struct MinimaAdapter {
  static constexpr std::string_view kName = "lattice_minima";
  static constexpr std::string_view kWorkUnit = "value";
  static constexpr std::string_view kSource = "local minima of paper equation (4) over a window";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.lattice_minima(params_of<LatticeMinima::Params>(launch.params), buffer_of<std::uint32_t>(launch, 0),
                             buffer_of<std::uint32_t>(launch, 1), launch.begin, launch.end);
  }
  static void check(const LatticeMinima::Params& params, const LaunchCheck& check) {
    const std::uint32_t samples = checked_samples(params.count_xy, params.count_theta, check);
    check.buffer(0, samples * sizeof(std::uint32_t));
    check.buffer(1, samples * sizeof(std::uint32_t));
    check.extent({samples, 1, 1});
  }
  static std::uint64_t work(const LatticeMinima::Params&, Extent threads) { return threads.x; }
};

}  // namespace

const KernelInfo& PoseLattice::info() {
  static const KernelInfo row = kernel_info<PoseLattice, LatticeAdapter>();
  return row;
}
const KernelInfo& LatticeMinima::info() {
  static const KernelInfo row = kernel_info<LatticeMinima, MinimaAdapter>();
  return row;
}

}  // namespace gdtslam
