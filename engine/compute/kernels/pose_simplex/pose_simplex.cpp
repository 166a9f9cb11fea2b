#include "pose_simplex.hpp"

#include <cassert>
#include <cmath>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost_check.hpp"

namespace gdtslam {
namespace {

/// Starts of a scan: those that were picked, and the pose that was there before.
constexpr std::uint32_t kMostPoses = SmallestValues::kMost + 1;

struct StartsAdapter {
  static constexpr std::string_view kName = "pose_starts";
  static constexpr std::string_view kWorkUnit = "value";
  static constexpr std::string_view kSource = "starts of several simplexes [Nelder1965]";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.pose_starts(params_of<PoseStarts::Params>(launch.params), buffer_of<PoseCandidate>(launch, 0),
                          buffer_of<std::uint32_t>(launch, 1), buffer_of<PolishedPose>(launch, 2), launch.begin,
                          launch.end);
  }
  static void check(const PoseStarts::Params& params, const LaunchCheck& check) {
    const std::uint32_t starts = check.threads().x;
    check.require(starts <= kMostPoses, "more than 17 starts");
    check.buffer(0, params.candidate_count * sizeof(PoseCandidate));
    check.buffer(1, starts > 0 ? (starts - 1) * 2 * sizeof(std::uint32_t) : 0);
    check.buffer(2, starts * sizeof(PolishedPose));
    check.extent({starts, 1, 1});
  }
  static std::uint64_t work(const PoseStarts::Params&, Extent threads) { return threads.x; }
};

struct SimplexAdapter {
  static constexpr std::string_view kName = "pose_simplex";
  static constexpr std::string_view kWorkUnit = "look-up";
  static constexpr std::string_view kSource = "linear simplex of the paper, [Nelder1965]";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.pose_simplex(params_of<PoseSimplex::Params>(launch.params), buffer_of<std::uint16_t>(launch, 0),
                           buffer_of<PointCells>(launch, 1), buffer_of<PolishedPose>(launch, 2) + launch.begin,
                           launch.end - launch.begin);
  }
  static void check(const PoseSimplex::Params& params, const LaunchCheck& check) {
    check_cost(params.cost, check);
    check.prior(params.prior);
    const auto is_size = [](float size) { return std::isfinite(size) && size >= 0.0F; };
    check.require(std::isfinite(params.step_cells) && std::isfinite(params.step_rad),
                  "a step of the first simplex is not finite");
    check.require(is_size(params.stop_cells) && is_size(params.stop_rad),
                  "a size to stop at is negative or not finite");
    check.require(params.max_evaluations <= PoseSimplex::kMostEvaluations, "more than 8,192 evaluations");
    check.buffer(2, check.threads().x * sizeof(PolishedPose));
    check.extent({check.threads().x, 1, 1});
  }
  /// As if every descent went to its limit: how far they go stands in the buffers.
  static std::uint64_t work(const PoseSimplex::Params& params, Extent threads) {
    return std::uint64_t{params.cost.point_count} * threads.x * params.max_evaluations;
  }
};

struct ChooseAdapter {
  static constexpr std::string_view kName = "choose_pose";
  static constexpr std::string_view kWorkUnit = "look-up";
  static constexpr std::string_view kSource = "paper equations (4) and (8), over the points that vote";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    const auto params = params_of<ChoosePose::Params>(launch.params);
    const std::size_t points = params.cost.point_count;
    functions.choose_pose(params, buffer_of<std::uint16_t>(launch, 0), buffer_of<PointCells>(launch, 1),
                          buffer_of<PolishedPose>(launch, 2), buffer_of<MatchVerdict>(launch, 3),
                          thread_scratch<std::uint16_t>(points), thread_scratch<PointCells>(points));
  }
  static void check(const ChoosePose::Params& params, const LaunchCheck& check) {
    check_cost(params.cost, check);
    check.prior(params.prior);
    check.require(params.cost.point_count <= ChoosePose::kMostPoints, "more than 65,535 points");
    check.require(params.pose_count > 0 && params.pose_count <= kMostPoses, "not 1 to 17 poses to choose from");
    check.require(params.map_cap <= 65535 && params.gate <= 65535, "the map's cap or the gate exceeds 16 bits");
    check.require(params.contradiction_q16 <= 65536 && params.overlap_q16 <= 65536,
                  "a share of points that makes pose 0 suspect is more than 1");
    check.require(params.far_sq_cells >= 0.0F && params.far_rad >= 0.0F, "a limit of far is negative or not a number");
    check.buffer(2, params.pose_count * sizeof(PolishedPose));
    check.buffer(3, sizeof(MatchVerdict));
    check.extent({1, 1, 1});
  }
  static std::uint64_t work(const ChoosePose::Params& params, Extent) {
    return std::uint64_t{params.cost.point_count} * (params.pose_count + 2);
  }
};

}  // namespace

const KernelInfo& PoseStarts::info() {
  static const KernelInfo row = kernel_info<PoseStarts, StartsAdapter>();
  return row;
}
const KernelInfo& PoseSimplex::info() {
  static const KernelInfo row = kernel_info<PoseSimplex, SimplexAdapter>();
  return row;
}
const KernelInfo& ChoosePose::info() {
  static const KernelInfo row = kernel_info<ChoosePose, ChooseAdapter>();
  return row;
}

void pose_simplex_host(Isa isa, const PoseSimplex::Params& params, const std::uint16_t* field, const PointCells* points,
                       PolishedPose* poses, std::uint32_t count) {
  assert(params.cost.width >= 2 && params.cost.height >= 2 && params.cost.stride >= params.cost.width);
  functions_or_throw(isa).pose_simplex(params, field, points, poses, count);
}

}  // namespace gdtslam
