#include "jump_flood.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

/// So that the sum of two squares stays below 2^31.
constexpr std::uint32_t kMostSide = 32767;

double distance_cells(std::uint32_t sq) { return std::sqrt(static_cast<double>(sq)); }

/// Bindings of `in_bytes` and `out_bytes` a cell.
template <class Params>
void check_pass(const Params& params, const LaunchCheck& check, std::size_t in_bytes, std::size_t out_bytes) {
  check.grid(params.width, params.height, params.stride, kMostSide);
  check.buffer(0, grid_bytes(params.width, params.height, params.stride, in_bytes));
  check.buffer(1, grid_bytes(params.width, params.height, params.stride, out_bytes));
  check.extent({params.width, params.height, 1});
}

}  // namespace

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

std::string_view to_string(JumpFloodVariant variant) {
  static constexpr std::array<std::string_view, 4> kNames{"jfa", "1+jfa", "jfa+2", "jfa^2"};
  static_assert(kNames.size() == static_cast<std::size_t>(JumpFloodVariant::kSquared) + 1);
  return kNames.at(static_cast<std::size_t>(variant));
}

std::vector<std::uint32_t> jump_flood_steps(JumpFloodVariant variant, std::uint32_t width, std::uint32_t height) {
  const std::uint32_t first = std::bit_ceil(std::max(width, height)) / 2;
  std::vector<std::uint32_t> steps;
  const auto halve_from = [&steps](std::uint32_t step) {
    for (; step > 0; step /= 2) {
      steps.push_back(step);
    }
  };
  if (variant == JumpFloodVariant::kOnePlus) {
    steps.push_back(1);
  }
  halve_from(first);
  if (variant == JumpFloodVariant::kPlusTwo) {
    halve_from(2);
  } else if (variant == JumpFloodVariant::kSquared) {
    halve_from(first);
  }
  return steps;
}

std::vector<std::uint32_t> jump_flood_steps_within(std::uint32_t radius) {
  return jump_flood_steps(JumpFloodVariant::kOnePlus, radius + 1, 1);
}

void jump_flood_host(Isa isa, const JumpFloodDistance::Params& params, std::span<const std::uint32_t> steps,
                     const std::uint8_t* seeds, std::uint32_t* nearest, std::uint32_t* scratch,
                     std::uint16_t* sq_distance) {
  assert(params.radius >= 1 && params.radius <= 255 && params.stride >= params.width);
  assert(params.width <= kMostSide && params.height <= kMostSide);
  const IsaFunctions& functions = functions_or_throw(isa);
  const CellRange all{0, params.width, 0, params.height};
  functions.jump_flood_init({params.width, params.height, params.stride}, seeds, nearest, all);
  for (const std::uint32_t step : steps) {
    functions.jump_flood_step({params.width, params.height, params.stride, step}, nearest, scratch, all);
    std::swap(nearest, scratch);
  }
  functions.jump_flood_distance(params, nearest, sq_distance, all);
}

JumpFloodError jump_flood_error(std::span<const std::uint16_t> exact, std::span<const std::uint16_t> approximate,
                                const JumpFloodInit::Params& shape) {
  JumpFloodError error;
  error.cells = std::uint64_t{shape.width} * shape.height;
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    for (std::uint32_t x = 0; x < shape.width; ++x) {
      const std::size_t cell = std::size_t{y} * shape.stride + x;
      error.wrong_cells += exact[cell] != approximate[cell] ? 1U : 0U;
      error.largest_cells =
          std::max(error.largest_cells, std::fabs(distance_cells(approximate[cell]) - distance_cells(exact[cell])));
    }
  }
  return error;
}

}  // namespace gdtslam
