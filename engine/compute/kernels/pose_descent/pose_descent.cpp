#include "pose_descent.hpp"

#include <cassert>
#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {

const KernelInfo& PoseDescent::info() {
  static const KernelInfo row = kernel_info<PoseDescent>(
      {"pose_descent", "look-up", "robust least squares on the field of paper equation (4), [Beaton1974]"},
      kCall<&IsaFunctions::pose_descent>,
      // Assumes that every descent reaches its limit: only the buffers know their lengths.
      [](const Params& params, Extent threads) -> std::uint64_t {
        return std::uint64_t{params.grid.point_count} * threads.x * params.max_evaluations;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.cost(params.grid);
        check.prior(params.prior);
        const auto is_size = [](float size) { return std::isfinite(size) && size >= 0.0F; };
        const auto is_width = [](float width) { return width >= 1.0e-3F && width <= 1.0e6F; };
        check.require(is_width(params.width) && is_width(params.last_width), "a width is not from 0.001 to 1e6");
        check.require(params.narrowing >= 0.0F && params.narrowing < 1.0F, "the narrowing is not from 0 to below 1");
        check.require(is_size(params.stop_cells) && is_size(params.stop_rad),
                      "a size to stop at is negative or not finite");
        check.require(params.max_evaluations <= PoseDescent::kMostEvaluations, "more than 56 evaluations");
        const std::size_t values = PoseDescent::row_of(params.grid.point_count);
        check.buffer(2, check.threads().x * sizeof(PolishedPose));
        check.buffer(3, check.threads().x * values * sizeof(std::uint16_t));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}

void pose_descent_host(Isa isa, const PoseDescent::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint16_t* values, std::uint32_t count) {
  assert(params.grid.width >= 2 && params.grid.height >= 2 && params.width > 0.0F && params.last_width > 0.0F);
  functions_or_throw(isa).pose_descent(params, field, points, poses, values, {0, count});
}

}  // namespace gdtslam
