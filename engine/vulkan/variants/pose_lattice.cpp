#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"

#include "variant_tools.hpp"

namespace gdtslam {
namespace {

/// Samples of an invocation on a CPU, where a group costs more than a sample.
constexpr std::uint32_t kNarrowSamples = 8;

template <std::uint32_t kPerGroup>
GroupCount groups(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kPerGroup);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "pose_lattice",
     .name = "pose_lattice",
     .spirv = shader::pose_lattice_spirv,
     .local_size = {64, 1, 1},
     .constants = {kNarrowSamples, 0},
     .groups = groups<64 * kNarrowSamples>,
     .suits = wants_narrow},
    {.kernel = "pose_lattice",
     .name = "pose_lattice",
     .spirv = shader::pose_lattice_spirv,
     .local_size = {128, 1, 1},
     .constants = {1, 0},
     .groups = groups<128>},
};

}  // namespace

std::span<const ShaderVariant> pose_lattice_variants() { return kVariants; }

}  // namespace gdtslam
