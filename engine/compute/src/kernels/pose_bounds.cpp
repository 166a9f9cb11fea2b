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

void field_minorant_host(Isa isa, const FieldMinorant::Params& params, const std::uint16_t* field,
                         std::uint32_t* minorants) {
  assert(params.reach >= 1 && params.reach < FieldMinorant::kMargin && params.stride >= params.width);
  functions_or_throw(isa).field_minorant(params, field, minorants, 0, params.height + 2 * FieldMinorant::kMargin);
}

void pose_minorant_wide_host(Isa isa, const PoseMinorantWide::Params& params, const std::uint32_t* minorants,
                             const BoundPoint* points, const PoseCandidate* boxes, std::uint32_t count,
                             PoseMinorant::Value* values) {
  assert(params.width > 0 && params.height > 0 && params.point_count <= PoseMinorant::kMostPoints);
  functions_or_throw(isa).pose_minorant_wide(params, minorants, points, boxes, count, values);
}

}  // namespace gdtslam
