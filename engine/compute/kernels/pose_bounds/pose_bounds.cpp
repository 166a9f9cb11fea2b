#include "pose_bounds.hpp"

#include <cassert>
#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

/// Largest number of points with a sum of bytes within the limits of pose_cost; a block is added in 16 bits.
constexpr std::uint32_t kMostPoints = 65537;
constexpr std::uint32_t kMostPhaseBits = 4;
/// Limit for indices in a dilation to fit 31 bits.
constexpr std::uint64_t kMostSamples = 0x7FFFFFFFU;

constexpr bool is_tile(const PoseBounds::Params& params) {
  return (params.tile_width == 2 && params.tile_height == 2) || (params.tile_width == 16 && params.tile_height == 4);
}

}  // namespace

const KernelInfo& PoseBounds::info() {
  static const KernelInfo row = kernel_info<PoseBounds>(
      {"pose_bounds", "look-up", "bounds of paper equation (4) over boxes of poses"}, kCall<&IsaFunctions::pose_bounds>,
      [](const Params& params, Extent threads) -> std::uint64_t {
        return std::uint64_t{params.point_count} * params.tile_width * params.tile_height * threads.x;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.require(is_tile(params), "tiles are 2 x 2 or 16 x 4");
        check.require(params.width >= params.tile_width && params.height >= params.tile_height,
                      "a plane of the field is smaller than a tile");
        check.require(params.phase_bits <= kMostPhaseBits, "more than 2^4 samples a spacing");
        const std::uint64_t planes = std::uint64_t{1} << (2 * params.phase_bits);
        check.require(std::uint64_t{params.width} * params.height <= kMostSamples / planes,
                      "a dilation of 2^31 samples or more");
        check.require(std::isfinite(params.samples_per_cell) && params.samples_per_cell > 0.0F,
                      "the samples per cell are no positive number");
        check.require(params.point_count <= kMostPoints, "more than 65,537 points");
        constexpr std::int32_t kFarthest = PoseBounds::kFarthestFirst;
        const auto in_reach = [](std::int32_t first) { return -kFarthest <= first && first <= kFarthest; };
        check.require(in_reach(params.first_column) && in_reach(params.first_row),
                      "the anchor is more than 2^21 samples off");
        const std::uint64_t samples = params.last_field + planes * params.width * params.height;
        check.require(samples <= 0xFFFFFFFFU, "a field of 2^32 samples or more");
        check.buffer(0, samples);
        check.buffer(1, params.point_count * sizeof(BoundPoint));
        check.buffer(2, check.threads().x * sizeof(PoseCandidate));
        check.buffer(3,
                     std::size_t{check.threads().x} * params.tile_width * params.tile_height * sizeof(std::uint32_t));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}

void pose_bounds_host(Isa isa, const PoseBounds::Params& params, const std::uint8_t* field, const BoundPoint* points,
                      const PoseCandidate* tiles, std::uint32_t count, std::uint32_t* sums) {
  assert(is_tile(params) && params.phase_bits <= kMostPhaseBits && params.point_count <= kMostPoints);
  assert(params.width >= params.tile_width && params.height >= params.tile_height);
  functions_or_throw(isa).pose_bounds(params, field, points, tiles, sums, {0, count});
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
  functions_or_throw(isa).field_minorant(params, field, minorants);
}

void pose_minorant_wide_host(Isa isa, const PoseMinorantWide::Params& params, const std::uint32_t* minorants,
                             const BoundPoint* points, const PoseCandidate* boxes, std::uint32_t count,
                             PoseMinorant::Value* values) {
  assert(params.width > 0 && params.height > 0 && params.point_count <= PoseMinorant::kMostPoints);
  functions_or_throw(isa).pose_minorant_wide(params, minorants, points, boxes, count, values);
}

}  // namespace gdtslam
