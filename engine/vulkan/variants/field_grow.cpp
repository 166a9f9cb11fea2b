#include "engine/compute/kernels/field_grow/field_grow.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kGroup = 64;
/// Words of two cells of an invocation.
constexpr std::uint32_t kWideWords = 1;
constexpr std::uint32_t kNarrowWords = 16;

template <std::uint32_t kWords>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<FieldGrow>(shape);
  const std::uint64_t words = (std::uint64_t{params.width} + 1) / 2;
  return groups_for((words + kWords - 1) / kWords * params.height, kGroup);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "field_grow",
     .name = "field_grow",
     .spirv = shader::field_grow_spirv,
     .local_size = {kGroup, 1, 1},
     .constants = {kNarrowWords, 0},
     .groups = groups<kNarrowWords>,
     .suits = wants_narrow},
    {.kernel = "field_grow",
     .name = "field_grow",
     .spirv = shader::field_grow_spirv,
     .local_size = {kGroup, 1, 1},
     .constants = {kWideWords, 0},
     .groups = groups<kWideWords>},
};

}  // namespace

std::span<const ShaderVariant> field_grow_variants() { return kVariants; }

}  // namespace gdtslam
