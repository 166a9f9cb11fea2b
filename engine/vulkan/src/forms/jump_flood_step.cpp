#include "forms/form_tools.hpp"
#include "forms/grid_launch.hpp"
#include "gdtslam/compute/kernels/jump_flood.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kNarrowQuads = 8;

template <std::uint32_t kColumns, std::uint32_t kRowsEach>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<JumpFloodStep>(shape);
  return grid_groups(params.width, kColumns, params.height, kRowsEach);
}

/// An invocation goes down the grid in jumps, so there are as many to a column as the jump has rows.
GroupCount chain_groups(const LaunchShape& shape) {
  const auto params = launch_params<JumpFloodStep>(shape);
  return grid_groups(divided_up(params.width, 4), kNarrowQuads, std::min(params.step, params.height), 1);
}

/// Jumps by whole quads for kShift 0, else jumps of kShift cells.
template <std::uint32_t kShift>
bool jumps(const FormContext& context) {
  const std::uint32_t step = launch_params<JumpFloodStep>(context.shape).step;
  constexpr std::uint32_t kLongest = 65536;  // longer ones reach no other cell
  return kShift == 0 ? step > 0 && step <= kLongest && step % 4 == 0 : step == kShift;
}

template <std::uint32_t kShift>
constexpr ShaderForm narrow_form() {
  return {.kernel = "jump_flood_step",
          .name = "jump_flood_step_narrow",
          .spirv = shader::jump_flood_step_narrow_spirv,
          .local_size = {kNarrowQuads, 1, 1},
          .constants = {kShift, 0},
          .groups = chain_groups,
          .suits = jumps<kShift>};
}

constexpr ShaderForm kForms[] = {
    {.kernel = "jump_flood_step",
     .name = "jump_flood_step",
     .spirv = shader::jump_flood_step_spirv,
     .local_size = {128, 1, 1},
     .groups = groups<128, 1>,
     .suits = wants_wide},
    narrow_form<0>(),
    narrow_form<1>(),
    narrow_form<2>(),
    {.kernel = "jump_flood_step",
     .name = "jump_flood_step",
     .spirv = shader::jump_flood_step_spirv,
     .local_size = {32, 1, 1},
     .groups = groups<32, 16>},
};

}  // namespace

std::span<const ShaderForm> jump_flood_step_forms() { return kForms; }

}  // namespace gdtslam
