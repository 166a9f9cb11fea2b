#include "pose_slope.hpp"

#include <cassert>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {

PoseSlope::Sums pose_slope_host(Isa isa, const PoseSlope::Params& params, const std::uint16_t* field,
                                const PointCells* points, const PoseSlope::Pose& pose) {
  const PoseCost::Params& grid = params.grid;
  assert(grid.width >= 2 && grid.height >= 2 && grid.stride >= grid.width && params.scale > 0.0F);
  static_cast<void>(grid);
  PoseSlope::Sums sums{};
  functions_or_throw(isa).pose_slope(params, field, points, pose, sums.data());
  return sums;
}

}  // namespace gdtslam
