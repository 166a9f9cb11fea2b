#include "pose_cost.hpp"

#include <cassert>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

/// Largest number of points whose 16-bit terms have a sum within 32 bits.
constexpr std::uint32_t kMostCostPoints = 65537;
/// Coordinates are clamped to 2^22 cells from the anchor, which is off the map in any direction within these limits.
constexpr std::int32_t kFarthestAnchor = 1 << 21;
constexpr std::uint32_t kFarthestCell = 1U << 21U;

}  // namespace

void LaunchCheck::cost(const PoseCost::Params& params) const {
  layout({params.stride, params.strip, params.blank}, params.width, params.height, kFarthestCell);
  const auto in_reach = [](std::int32_t anchor) { return -kFarthestAnchor <= anchor && anchor <= kFarthestAnchor; };
  require(in_reach(params.anchor_x) && in_reach(params.anchor_y), "the anchor is more than 2^21 cells off");
  require(params.width >= 2 && params.height >= 2, "the field must be at least 2 x 2 cells");
  require(params.point_count <= kMostCostPoints, "more than 65,537 points");
  require(params.cap <= 65535, "the cap exceeds 16 bits");
  require(params.interpolation <= Interpolation::kNearest && params.form <= CostForm::kSquared,
          "unknown interpolation or form");
  buffer(0, field_bytes({params.stride, params.strip, params.blank}, params.width, params.height));
  buffer(1, params.point_count * sizeof(PointCells));
}

const KernelInfo& PoseCost::info() {
  static const KernelInfo row = kernel_info<PoseCost>(
      {"pose_cost", "look-up", "paper equation (4)"}, kCall<&IsaFunctions::pose_cost>,
      [](const Params& params, Extent threads) -> std::uint64_t {
        return std::uint64_t{params.point_count} * threads.x;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.cost(params);
        check.buffer(2, check.threads().x * sizeof(PoseCandidate));
        check.buffer(3, check.threads().x * sizeof(std::uint32_t));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}

void pose_cost_host(Isa isa, const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points,
                    const PoseCandidate* candidates, std::uint32_t count, std::uint32_t* cost) {
  assert(params.width >= 2 && params.height >= 2 && params.point_count <= kMostCostPoints);
  functions_or_throw(isa).pose_cost(params, field, points, candidates, cost, {0, count});
}

void point_values_host(Isa isa, const PointValues::Params& params, const std::uint16_t* field, const PointCells* points,
                       const PointValues::Pose& pose, std::uint16_t* values) {
  assert(params.width >= 1 && params.height >= 1);
  functions_or_throw(isa).point_values(params, field, points, pose, values);
}

void pose_simplex_host(Isa isa, const PoseSimplex::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint32_t count) {
  assert(params.cost.width >= 2 && params.cost.height >= 2);
  functions_or_throw(isa).pose_simplex(params, field, points, poses, {0, count});
}

}  // namespace gdtslam
