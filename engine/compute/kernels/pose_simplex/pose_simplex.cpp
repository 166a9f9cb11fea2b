#include "pose_simplex.hpp"

#include <cassert>
#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

/// Starts of a scan: the picked ones, and the previous pose.
constexpr std::uint32_t kMostPoses = SmallestValues::kMost + 1;

}  // namespace

const KernelInfo& PoseStarts::info() {
  static const KernelInfo row = kernel_info<PoseStarts>(
      {"pose_starts", "value", "starts of several simplexes [Nelder1965]"}, kCall<&IsaFunctions::pose_starts>, kThings,
      [](const Params& params, const LaunchCheck& check) {
        const std::uint32_t starts = check.threads().x;
        check.require(starts <= kMostPoses, "more than 17 starts");
        check.buffer(0, params.candidate_count * sizeof(PoseCandidate));
        check.buffer(1, starts > 0 ? (starts - 1) * 2 * sizeof(std::uint32_t) : 0);
        check.buffer(2, starts * sizeof(PolishedPose));
        check.extent({starts, 1, 1});
      });
  return row;
}
const KernelInfo& PoseSimplex::info() {
  static const KernelInfo row = kernel_info<PoseSimplex>(
      {"pose_simplex", "look-up", "linear simplex of the paper, [Nelder1965]"}, kCall<&IsaFunctions::pose_simplex>,
      // Assumes that every descent reaches its limit: only the buffers know their lengths.
      [](const Params& params, Extent threads) -> std::uint64_t {
        return std::uint64_t{params.cost.point_count} * threads.x * params.max_evaluations;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.cost(params.cost);
        check.prior(params.prior);
        const auto is_size = [](float size) { return std::isfinite(size) && size >= 0.0F; };
        check.require(std::isfinite(params.step_cells) && std::isfinite(params.step_rad),
                      "a step of the first simplex is not finite");
        check.require(is_size(params.stop_cells) && is_size(params.stop_rad),
                      "a size to stop at is negative or not finite");
        check.require(params.max_evaluations <= PoseSimplex::kMostEvaluations, "more than 8,192 evaluations");
        check.buffer(2, check.threads().x * sizeof(PolishedPose));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}
const KernelInfo& ChoosePose::info() {
  static const KernelInfo row = kernel_info<ChoosePose>(
      {"choose_pose", "look-up", "paper equations (4) and (8), over the points that vote"},
      [](const IsaFunctions& functions, const CpuLaunch& launch) {
        const auto params = read_params<ChoosePose::Params>(launch.params);
        const std::size_t points = params.cost.point_count;
        functions.choose_pose(params, typed_buffer<std::uint16_t>(launch, 0), typed_buffer<PointCells>(launch, 1),
                              typed_buffer<PolishedPose>(launch, 2), typed_buffer<MatchVerdict>(launch, 3),
                              thread_scratch<std::uint16_t>(points), thread_scratch<PointCells>(points));
      },
      [](const Params& params, Extent) -> std::uint64_t {
        return std::uint64_t{params.cost.point_count} * (params.pose_count + 2);
      },
      [](const Params& params, const LaunchCheck& check) {
        check.cost(params.cost);
        check.prior(params.prior);
        check.require(params.cost.point_count <= ChoosePose::kMostPoints, "more than 65,535 points");
        check.require(params.pose_count > 0 && params.pose_count <= kMostPoses, "not 1 to 17 poses to choose from");
        check.require(params.map_cap <= 65535 && params.gate <= 65535, "the map's cap or the gate exceeds 16 bits");
        check.require(params.contradiction_q16 <= 65536 && params.overlap_q16 <= 65536,
                      "a share of points that makes pose 0 suspect is more than 1");
        check.require(params.far_sq_cells >= 0.0F && params.far_rad >= 0.0F,
                      "a limit of far is negative or not a number");
        check.buffer(2, params.pose_count * sizeof(PolishedPose));
        check.buffer(3, sizeof(MatchVerdict));
        check.extent({1, 1, 1});
      });
  return row;
}

void pose_simplex_host(Isa isa, const PoseSimplex::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint32_t count) {
  assert(params.cost.width >= 2 && params.cost.height >= 2);
  functions_or_throw(isa).pose_simplex(params, field, points, poses, {0, count});
}

}  // namespace gdtslam
