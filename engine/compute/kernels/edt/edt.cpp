#include "edt.hpp"

#include <cassert>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

/// A pass reads bytes and writes values of `out_bytes`.
void check_pass(const EdtColumns::Params& params, const LaunchCheck& check, std::size_t out_bytes) {
  check.grid(params.width, params.height, params.stride, kNoLimit);
  check.buffer(0, grid_bytes(params.width, params.height, params.stride, 1));
  check.buffer(1, grid_bytes(params.width, params.height, params.stride, out_bytes));
  check.require(params.radius >= 1 && params.radius <= 255, "the radius must be 1 to 255 cells");
}

constexpr std::uint32_t kMostSideOfList = 65535;  // a coordinate of a listed cell has 16 bits

}  // namespace

const KernelInfo& EdtColumns::info() {
  static const KernelInfo row = kernel_info<EdtColumns>(
      {"edt_columns", "cell", "[Meijster2000], first phase, truncated; paper equation (1)"},
      kCall<&IsaFunctions::edt_columns>, kCells, [](const Params& params, const LaunchCheck& check) {
        check_pass(params, check, 1);
        check.extent({params.width, 1, 1});
      });
  return row;
}
const KernelInfo& EdtRows::info() {
  static const KernelInfo row = kernel_info<EdtRows>(
      {"edt_rows", "cell", "separable minimum over a window of 2R+1 cells; paper equation (1)"},
      [](const IsaFunctions& functions, const CpuLaunch& launch) {
        const auto params = params_of<EdtRows::Params>(launch.params);
        functions.edt_rows(params, buffer_of<std::uint8_t>(launch, 0), buffer_of<std::uint16_t>(launch, 1),
                           {launch.begin, launch.end}, thread_scratch<std::uint16_t>(edt_rows_scratch(params)));
      },
      kCells,
      [](const Params& params, const LaunchCheck& check) {
        check_pass(params, check, 2);
        check.extent({1, params.height, 1});
      });
  return row;
}
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

void edt_host(Isa isa, const EdtColumns::Params& params, const std::uint8_t* seeds, std::uint8_t* column_distance,
              std::uint16_t* sq_distance) {
  assert(params.radius >= 1 && params.radius <= 255 && params.stride >= params.width);
  if (params.width == 0 || params.height == 0) {
    return;
  }
  const IsaFunctions& functions = functions_or_throw(isa);
  functions.edt_columns(params, seeds, column_distance, {0, params.width});
  functions.edt_rows(params, column_distance, sq_distance, {0, params.height},
                     thread_scratch<std::uint16_t>(edt_rows_scratch(params)));
}

}  // namespace gdtslam
