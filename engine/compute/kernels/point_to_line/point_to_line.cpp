#include "point_to_line.hpp"

#include <cassert>
#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {

const KernelInfo& PointToLine::info() {
  static const KernelInfo row = kernel_info<PointToLine>(
      {"point_to_line", "pair", "points on the lines of another scan, [Censi2008]"},
      kCall<&IsaFunctions::point_to_line>, kThings, [](const Params& params, const LaunchCheck& check) {
        check.require(params.gate_m2 >= 0.0F && params.gate_m2 <= 1.0e15F, "the gate is not from 0 to 1e15");
        check.require(params.per_kernel_m2 >= 0.0F && params.per_kernel_m2 <= 1.0e15F,
                      "the kernel's scale is not from 0 to 1e15");
        check.require(std::isfinite(params.least_cosine), "the least cosine is not finite");
        check.buffer(2, check.threads().x * sizeof(Pair));
        check.buffer(3, check.threads().x * sizeof(Sums));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}

void find_lines_host(Isa isa, const PointToLine::Params& params, const PointToLine::Pose& pose,
                     const PointToLine::Scan& fixed, const PointToLine::Scan& moving, std::uint32_t every,
                     std::span<std::int32_t> found) {
  assert(fixed.count >= PointToLine::kCandidates);
  functions_or_throw(isa).find_lines(params, pose, fixed, moving, every, static_cast<std::uint32_t>(found.size()),
                                     found.data());
}

PointToLine::Sums line_slope_host(Isa isa, const PointToLine::Params& params, const PointToLine::Pose& pose,
                                  const PointToLine::Scan& fixed, const PointToLine::Scan& moving, std::uint32_t every,
                                  std::span<const std::int32_t> found) {
  PointToLine::Sums sums{};
  functions_or_throw(isa).line_slope(params, pose, fixed, moving, every, static_cast<std::uint32_t>(found.size()),
                                     found.data(), sums.data());
  return sums;
}

}  // namespace gdtslam
