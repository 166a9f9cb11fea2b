#include "pose_cost.hpp"

#include <cassert>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "pose_cost_check.hpp"

namespace gdtslam {
namespace {

/// Most points whose 16-bit terms sum up within 32 bits.
constexpr std::uint32_t kMostPoints = 65537;
/// Coordinates are clamped to 2^22 cells from the anchor, which is off the map in any direction within these limits.
constexpr std::int32_t kFarthestAnchor = 1 << 21;
constexpr std::uint32_t kFarthestCell = 1U << 21U;

struct CostAdapter {
  static constexpr std::string_view kName = "pose_cost";
  static constexpr std::string_view kWorkUnit = "look-up";
  static constexpr std::string_view kSource = "paper equation (4)";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.pose_cost(params_of<PoseCost::Params>(launch.params), buffer_of<std::uint16_t>(launch, 0),
                        buffer_of<PointCells>(launch, 1), buffer_of<PoseCandidate>(launch, 2) + launch.begin,
                        launch.end - launch.begin, buffer_of<std::uint32_t>(launch, 3) + launch.begin);
  }
  static void check(const PoseCost::Params& params, const LaunchCheck& check) {
    check_cost(params, check);
    check.buffer(2, check.threads().x * sizeof(PoseCandidate));
    check.buffer(3, check.threads().x * sizeof(std::uint32_t));
    check.extent({check.threads().x, 1, 1});
  }
  static std::uint64_t work(const PoseCost::Params& params, Extent threads) {
    return std::uint64_t{params.point_count} * threads.x;
  }
};

}  // namespace

void check_cost(const PoseCost::Params& params, const LaunchCheck& check) {
  check.grid(params.width, params.height, params.stride, kFarthestCell);
  const auto in_reach = [](std::int32_t anchor) { return -kFarthestAnchor <= anchor && anchor <= kFarthestAnchor; };
  check.require(in_reach(params.anchor_x) && in_reach(params.anchor_y), "the anchor is more than 2^21 cells off");
  check.require(params.width >= 2 && params.height >= 2, "the field must be at least 2 x 2 cells");
  check.require(params.point_count <= kMostPoints, "more than 65,537 points");
  check.require(params.cap <= 65535, "the cap exceeds 16 bits");
  check.require(params.interpolation <= Interpolation::kNearest && params.form <= CostForm::kSquared,
                "unknown interpolation or form");
  check.buffer(0, grid_bytes(params.width, params.height, params.stride, 2));
  check.buffer(1, params.point_count * sizeof(PointCells));
}

const KernelInfo& PoseCost::info() {
  static const KernelInfo row = kernel_info<PoseCost, CostAdapter>();
  return row;
}

void pose_cost_host(Isa isa, const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points,
                    const PoseCandidate* candidates, std::uint32_t count, std::uint32_t* cost) {
  assert(params.width >= 2 && params.height >= 2 && params.stride >= params.width && params.point_count <= kMostPoints);
  functions_or_throw(isa).pose_cost(params, field, points, candidates, count, cost);
}

}  // namespace gdtslam
