#include "ndt_cost.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <iterator>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostNdtSide = 1U << 16U;
constexpr std::uint64_t kMostNdtCubes = std::uint64_t{1} << 28U;
constexpr std::uint32_t kMostDistributions = 1U << 24U;
constexpr float kMostPerUnit = 1.0e6F;

std::uint64_t ndt_cubes(const NdtCost::Params& params) {
  return std::uint64_t{params.size_x} * params.size_y * params.size_z;
}

std::size_t ndt_map_bytes(const NdtCost::Params& params) {
  return (NdtCost::kSteps + ndt_cubes(params)) * sizeof(std::uint32_t) +
         params.distribution_count * sizeof(NdtCost::Distribution);
}

void check_ndt_map(const NdtCost::Params& params, const LaunchCheck& check) {
  const auto is_rate = [](float rate) { return rate > 0.0F && rate <= kMostPerUnit; };
  check.require(std::max({params.size_x, params.size_y, params.size_z}) <= kMostNdtSide,
                "a side of the box has more than 65,536 cubes");
  check.require(ndt_cubes(params) <= kMostNdtCubes, "the box has more than 2^28 cubes");
  check.require(params.distribution_count <= kMostDistributions, "more than 2^24 distributions");
  check.require(
      std::isfinite(params.origin_x_m) && std::isfinite(params.origin_y_m) && std::isfinite(params.origin_z_m),
      "the origin of the box is not finite");
  check.require(is_rate(params.cubes_per_m), "cubes per metre are not above 0 and at most 1e6");
  check.require(is_rate(params.steps_per_unit), "steps per unit are not above 0 and at most 1e6");
}

}  // namespace

const KernelInfo& NdtCost::info() {
  static const KernelInfo row = kernel_info<NdtCost>(
      {"ndt_cost", "look-up", "normal distributions, [BiberStrasser2003]"}, kCall<&IsaFunctions::ndt_cost>,
      [](const Params& params, Extent threads) -> std::uint64_t {
        return std::uint64_t{params.point_count} * threads.x;
      },
      [](const Params& params, const LaunchCheck& check) {
        check_ndt_map(params, check);
        check.require(params.point_count <= NdtCost::kMostPoints, "more than 2^20 points");
        check.require(check.threads().x <= NdtCost::kMostPoses, "more than 2^20 poses");
        check.buffer(0, ndt_map_bytes(params));
        check.buffer(1, params.point_count * sizeof(Point));
        check.buffer(2, check.threads().x * sizeof(Pose));
        check.buffer(3, check.threads().x * sizeof(std::uint32_t));
        check.extent({check.threads().x, 1, 1});
      });
  return row;
}

std::vector<std::uint32_t> make_ndt_map(std::span<const std::uint32_t, NdtCost::kSteps> table,
                                        std::span<const NdtCost::Distribution> distributions,
                                        std::span<const std::int32_t> cubes) {
  if (std::ranges::max(table) > NdtCost::kMostScore || table.back() != 0) {
    refuse_launch(NdtCost::info().name, "a score is above 4,095, or the last one is not 0");
  }
  std::vector<std::uint32_t> words(table.begin(), table.end());
  words.resize(words.size() + distributions.size_bytes() / sizeof(std::uint32_t));
  if (!distributions.empty()) std::memcpy(&words[table.size()], distributions.data(), distributions.size_bytes());
  words.reserve(words.size() + cubes.size());
  std::ranges::transform(cubes, std::back_inserter(words),
                         [](std::int32_t i) { return static_cast<std::uint32_t>(i); });
  return words;
}

void ndt_cost_host(Isa isa, const NdtCost::Params& params, std::span<const std::uint32_t> map,
                   std::span<const NdtCost::Point> points, std::span<const NdtCost::Pose> poses,
                   std::span<std::uint32_t> scores) {
  assert(map.size_bytes() >= ndt_map_bytes(params) && points.size() == params.point_count);
  assert(points.size() <= NdtCost::kMostPoints && poses.size() == scores.size());
  functions_or_throw(isa).ndt_cost(params, map.data(), points.data(), poses.data(), scores.data(),
                                   {0, static_cast<std::uint32_t>(poses.size())});
}

}  // namespace gdtslam
