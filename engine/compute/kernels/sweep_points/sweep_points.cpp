#include "sweep_points.hpp"

#include <cmath>

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostBits = 20;
/// Limit for the bytes of the points to fit 32 bits.
constexpr std::uint32_t kMostBeams = 1U << 27U;
/// Limit for the number of table values to fit 32 bits.
constexpr std::uint32_t kMostDirections = 1U << 28U;

}  // namespace

const KernelInfo& SweepPoints::info() {
  static const KernelInfo row = kernel_info<SweepPoints>(
      {"sweep_points", "beam", "paper equations (12), (13) and (14)"}, kCall<&IsaFunctions::sweep_points>,
      [](const Params& params, Extent) -> std::uint64_t { return params.beams; },
      [](const Params& params, const LaunchCheck& check) {
        check.require(params.table_bits <= kMostBits, "a table of elevations of more than 2^20 + 1 entries");
        check.require(params.beams <= kMostBeams, "more than 2^27 beams");
        check.require(params.form == SweepForm::kWorking || params.form == SweepForm::kLiteral,
                      "an unknown form of (14)");
        check.require(
            std::isfinite(params.lever_x_m) && std::isfinite(params.lever_z_m) && std::isfinite(params.height_m),
            "a length of the mount is not finite");
        check.require(params.directions <= kMostDirections, "more than 2^28 directions");
        check.require(params.beams == 0 || (params.strips > 0 && params.directions > 0),
                      "beams without a strip or without a direction");
        check.buffer(0, std::size_t{params.beams} * sizeof(BeamRange));
        check.buffer(1, std::size_t{params.strips} * sizeof(BeamStrip));
        check.buffer(2,
                     (SweepPoints::elevations(params.table_bits) + 3 * std::size_t{params.directions}) * sizeof(float));
        check.buffer(3, std::size_t{params.beams} * 4 * sizeof(float));
        check.extent({params.beams, 1, 1});
      });
  return row;
}

}  // namespace gdtslam
