#include "gdtslam/compute/kernels/jump_flood.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "gdtslam/compute/kernels/edt.hpp"
#include "launch.hpp"

namespace gdtslam {
namespace {

double distance_cells(std::uint32_t sq) { return std::sqrt(static_cast<double>(sq)); }

template <class Params>
std::uint64_t cells(const Params& params) {
  return std::uint64_t{params.width} * params.height;
}

template <class Params>
void check_pass(const Params& params, const LaunchCheck& check, std::size_t in_bytes) {
  check.grid(params.width, params.height, params.stride, kFullLimit);
  check.buffer(0, grid_bytes(params.width, params.height, params.stride, in_bytes));
  check.buffer(1, grid_bytes(params.width, params.height, params.stride, 4));
  check.extent({params.width, params.height, 1});
}

struct InitAdapter {
  static constexpr std::string_view kName = "jump_flood_init";
  static constexpr std::string_view kWorkUnit = "cell";
  static constexpr std::string_view kSource = "[Rong2006]";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.jump_flood_init(params_of<JumpFloodInit::Params>(launch.params), buffer_of<std::uint8_t>(launch, 0),
                              buffer_of<std::uint32_t>(launch, 1), cell_range(launch));
  }
  static void check(const JumpFloodInit::Params& params, const LaunchCheck& check) { check_pass(params, check, 1); }
  static std::uint64_t work(const JumpFloodInit::Params& params, Extent) { return cells(params); }
};

struct StepAdapter {
  static constexpr std::string_view kName = "jump_flood_step";
  static constexpr std::string_view kWorkUnit = "cell";
  static constexpr std::string_view kSource = "[Rong2006], variants [Rong2007]";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.jump_flood_step(params_of<JumpFloodStep::Params>(launch.params), buffer_of<std::uint32_t>(launch, 0),
                              buffer_of<std::uint32_t>(launch, 1), cell_range(launch));
  }
  static void check(const JumpFloodStep::Params& params, const LaunchCheck& check) {
    check_pass(params, check, 4);
    check.require(params.step >= 1 && params.step <= kFullLimit, "the step must be 1 to 32767 cells");
  }
  static std::uint64_t work(const JumpFloodStep::Params& params, Extent) { return cells(params); }
};

struct DistanceAdapter {
  static constexpr std::string_view kName = "jump_flood_distance";
  static constexpr std::string_view kWorkUnit = "cell";
  static constexpr std::string_view kSource = "[Rong2006]";
  static void call(const IsaFunctions& functions, const CpuLaunch& launch) {
    functions.jump_flood_distance(params_of<JumpFloodDistance::Params>(launch.params),
                                  buffer_of<std::uint32_t>(launch, 0), buffer_of<std::uint32_t>(launch, 1),
                                  cell_range(launch));
  }
  static void check(const JumpFloodDistance::Params& params, const LaunchCheck& check) { check_pass(params, check, 4); }
  static std::uint64_t work(const JumpFloodDistance::Params& params, Extent) { return cells(params); }
};

}  // namespace

const KernelInfo& JumpFloodInit::info() {
  static const KernelInfo row = kernel_info<JumpFloodInit, InitAdapter>();
  return row;
}
const KernelInfo& JumpFloodStep::info() {
  static const KernelInfo row = kernel_info<JumpFloodStep, StepAdapter>();
  return row;
}
const KernelInfo& JumpFloodDistance::info() {
  static const KernelInfo row = kernel_info<JumpFloodDistance, DistanceAdapter>();
  return row;
}

std::string_view name_of(JumpFloodVariant variant) {
  switch (variant) {
    case JumpFloodVariant::kPlain:
      return "jfa";
    case JumpFloodVariant::kOnePlus:
      return "1+jfa";
    case JumpFloodVariant::kPlusTwo:
      return "jfa+2";
    case JumpFloodVariant::kSquared:
      return "jfa^2";
  }
  return "unknown";
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

JumpFloodError jump_flood_error(std::span<const std::uint32_t> exact, std::span<const std::uint32_t> approximate,
                                const JumpFloodInit::Params& shape) {
  JumpFloodError error;
  error.cells = cells(shape);
  for (std::uint32_t y = 0; y < shape.height; ++y) {
    for (std::uint32_t x = 0; x < shape.width; ++x) {
      const std::size_t cell = std::size_t{y} * shape.stride + x;
      const std::uint32_t right = exact[cell];
      const std::uint32_t found = approximate[cell];
      if (right == found) {
        continue;
      }
      ++error.wrong_cells;
      const bool one_missing = right == kNoSeed || found == kNoSeed;
      const double difference = one_missing ? std::numeric_limits<double>::infinity()
                                            : std::fabs(distance_cells(found) - distance_cells(right));
      error.largest_cells = std::max(error.largest_cells, difference);
    }
  }
  return error;
}

}  // namespace gdtslam
