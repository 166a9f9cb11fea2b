#include "gdtslam/compute/kernels/pose_bounds.hpp"

#include <cassert>

#include "gdtslam/compute/host_kernels.hpp"
#include "launch.hpp"

namespace gdtslam {

void pose_bounds_host(Isa isa, const PoseBounds::Params& params, const std::uint8_t* field, const BoundPoint* points,
                      const PoseCandidate* tiles, std::uint32_t count, std::uint32_t* sums) {
  assert((params.tile_width == 2 && params.tile_height == 2) || (params.tile_width == 16 && params.tile_height == 4));
  assert(params.width >= params.tile_width && params.height >= params.tile_height);
  functions_or_throw(isa).pose_bounds(params, field, points, tiles, count, sums);
}

void pose_minorant_host(Isa isa, const PoseMinorant::Params& params, const std::uint16_t* field,
                        const PointCells* points, const PoseCandidate* boxes, std::uint32_t count,
                        PoseMinorant::Value* values) {
  assert(params.width >= 4 && params.height >= 4 && params.point_count <= PoseMinorant::kMostPoints);
  functions_or_throw(isa).pose_minorant(params, field, points, boxes, count, values);
}

}  // namespace gdtslam
