#include "jump_flood.hpp"

#include <bit>

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {
namespace {

/// Limit for the sum of two squares to stay below 2^31.
constexpr std::uint32_t kMostSide = 32767;

constexpr std::uint32_t kMostSideOfList = 65535;  // a coordinate of a listed cell has 16 bits

/// Bindings of `in_bytes` and `out_bytes` a cell.
template <class Params>
void check_pass(const Params& params, const LaunchCheck& check, std::size_t in_bytes, std::size_t out_bytes) {
  check.grid(params.width, params.height, params.stride, kMostSide);
  check.buffer(0, grid_bytes(params.width, params.height, params.stride, in_bytes));
  check.buffer(1, grid_bytes(params.width, params.height, params.stride, out_bytes));
  check.extent({params.width, params.height, 1});
}

}  // namespace

const KernelInfo& SeedScatter::info() {
  static const KernelInfo row = kernel_info<SeedScatter>(
      {"seed_scatter", "cell", "seeds of paper equation (1)"}, kCall<&IsaFunctions::seed_scatter>,
      [](const Params& params, Extent) -> std::uint64_t { return params.count; },
      [](const Params& params, const LaunchCheck& check) {
        check.grid(params.width, params.height, params.stride, kMostSideOfList);
        check.buffer(0, std::size_t{params.count} * 4);
        check.buffer(1, grid_bytes(params.width, params.height, params.stride, 1));
        check.extent({params.count, 1, 1});
      });
  return row;
}
const KernelInfo& JumpFloodInit::info() {
  static const KernelInfo row = kernel_info<JumpFloodInit>(
      {"jump_flood_init", "cell", "[Rong2006]"}, kCall<&IsaFunctions::jump_flood_init>, kCells,
      [](const Params& params, const LaunchCheck& check) { check_pass(params, check, 1, 4); });
  return row;
}
const KernelInfo& JumpFloodStep::info() {
  static const KernelInfo row = kernel_info<JumpFloodStep>(
      {"jump_flood_step", "cell", "[Rong2006], variants [Rong2007]"}, kCall<&IsaFunctions::jump_flood_step>, kCells,
      [](const Params& params, const LaunchCheck& check) {
        check_pass(params, check, 4, 4);
        check.require(params.step >= 1 && params.step <= kMostSide, "the step must be 1 to 32767 cells");
      });
  return row;
}
const KernelInfo& JumpFloodDistance::info() {
  static const KernelInfo row = kernel_info<JumpFloodDistance>(
      {"jump_flood_distance", "cell", "[Rong2006]"}, kCall<&IsaFunctions::jump_flood_distance>, kCells,
      [](const Params& params, const LaunchCheck& check) {
        check_pass(params, check, 4, 2);
        check.require(params.radius >= 1 && params.radius <= 255, "the radius must be 1 to 255 cells");
      });
  return row;
}

std::vector<std::uint32_t> jump_flood_steps_within(std::uint32_t radius) {
  std::vector<std::uint32_t> steps{1};
  for (std::uint32_t step = std::bit_floor(radius); step > 0; step /= 2) steps.push_back(step);
  return steps;
}

}  // namespace gdtslam
