#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "variant_tools.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kGroup = 64;
/// Samples of an invocation: a column of nine is loaded once a sample, and two more columns once an invocation.
constexpr std::uint32_t kWidePiece = 4;
constexpr std::uint32_t kNarrowPiece = 16;

template <std::uint32_t kPiece>
GroupCount groups(const LaunchShape& shape) {
  const auto params = launch_params<LatticeMinima>(shape);
  const std::uint64_t pieces = (params.count_xy + kPiece - 1) / kPiece;
  return groups_for(pieces * params.count_xy * params.count_theta, kGroup);
}

constexpr ShaderVariant kVariants[] = {
    {.kernel = "lattice_minima",
     .name = "lattice_minima",
     .spirv = shader::lattice_minima_spirv,
     .local_size = {kGroup, 1, 1},
     .constants = {kNarrowPiece, 0},
     .groups = groups<kNarrowPiece>,
     .suits = wants_narrow},
    {.kernel = "lattice_minima",
     .name = "lattice_minima",
     .spirv = shader::lattice_minima_spirv,
     .local_size = {kGroup, 1, 1},
     .constants = {kWidePiece, 0},
     .groups = groups<kWidePiece>},
};

}  // namespace

std::span<const ShaderVariant> lattice_minima_variants() { return kVariants; }

}  // namespace gdtslam
