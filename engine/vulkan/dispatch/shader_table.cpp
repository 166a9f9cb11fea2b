// The shader for each launch and device: the rows of every kernel, in the order of the registry. The first suitable row
// is chosen, and the last row of a kernel always suits.
#include "shader_table.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/ndt_cost/ndt_cost.hpp"
#include "engine/compute/kernels/point_to_line/point_to_line.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_descent/pose_descent.hpp"
#include "shaders.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  // groups of one dimension, on every device

/// The parameters of a launch of kernel K.
template <class K>
typename K::Params launch_params(const LaunchShape& shape) {
  typename K::Params params;
  std::memcpy(&params, shape.params.data(), sizeof(params));
  return params;
}

constexpr std::uint64_t divided_up(std::uint64_t count, std::uint64_t part) { return (count + part - 1) / part; }

// ------------------------------------------------------------------------------------------------ numbers of groups

/// Groups that cover `count` items, `per_group` each: folded into rows of at most 65535, so a shader's linear group is
/// gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x and may exceed the count.
GroupCount groups_for(std::uint64_t count, std::uint32_t per_group) {
  const std::uint64_t groups = divided_up(count, per_group);
  const std::uint64_t rows = std::max<std::uint64_t>(1, divided_up(groups, kMostGroups));
  return {static_cast<std::uint32_t>(std::min<std::uint64_t>(groups, kMostGroups)), static_cast<std::uint32_t>(rows),
          1};
}

/// Groups of a grid launch: along x they cover `columns` items, along y `rows` rows. A shader loops over rows that the
/// launch does not cover (launch_rows() in shaders/common/launch.glsl), so any number of rows is allowed.
GroupCount grid_groups(std::uint64_t columns, std::uint32_t group_columns, std::uint32_t rows) {
  return {static_cast<std::uint32_t>(divided_up(columns, group_columns)), std::min(rows, kMostGroups), 1};
}

template <std::uint32_t kPerGroup>
GroupCount linear(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kPerGroup);
}

constexpr std::uint32_t kGroup = 128;  // invocations that every device supports

/// Groups for a kernel over its grid, with `kCellsEach` neighbours of a row per invocation.
template <class K, std::uint32_t kCellsEach>
GroupCount grid(const LaunchShape& shape) {
  const auto params = launch_params<K>(shape);
  return grid_groups(divided_up(params.width, kCellsEach), kGroup, params.height);
}

/// Quads in the global field's row that overlap the scan's field.
GroupCount merged_quads(const LaunchShape& shape) {
  const auto params = launch_params<GdtMerge>(shape);
  const std::uint64_t end = divided_up(std::uint64_t{params.offset_x} + params.scan_width, 4);
  return grid_groups(end - params.offset_x / 4, kGroup, params.scan_height);
}

/// Quads of all stamped tiles.
GroupCount stamped_quads(const LaunchShape& shape) {
  return groups_for(std::uint64_t{shape.threads.x} * (kStampTile * kStampTile / 4), kGroup);
}

/// Words of two cells of the new field, one per invocation.
GroupCount grown_words(const LaunchShape& shape) {
  const auto params = launch_params<FieldGrow>(shape);
  return groups_for(divided_up(params.width, 2) * params.height, kGroup);
}

// ------------------------------------------------------------------------------------------------ which row suits

// lavapipe leaves every loop after its first turn once an invocation has taken 65,535 in all its loops together
// (measured, Mesa 22.3), without any message: the longest descent's have to be fewer. An evaluation takes a turn for
// 64 points, 6 for the sums, at most 7 for the damping, and its own.
constexpr std::uint32_t kMostPointTurns = 65537U / PoseDescent::kLanes + 1;
static_assert(PoseDescent::kMostEvaluations * (kMostPointTurns + 14) + kMostPointTurns < 65535);
constexpr std::uint32_t kNdtGroup = 64;
static_assert(NdtCost::kMostPoints / kNdtGroup + 6 < 65535);

// Constants of the shaders appear in the rows as numbers: 0 and 1.
constexpr std::uint32_t kBilinear = static_cast<std::uint32_t>(Interpolation::kBilinear);
constexpr std::uint32_t kNearest = static_cast<std::uint32_t>(Interpolation::kNearest);
constexpr std::uint32_t kSmallTiles = 0;
constexpr std::uint32_t kWideTiles = 1;  // tiles of 16 x 4 boxes

template <std::uint32_t kInterpolation>
bool costs_by(const VariantContext& context) {
  return static_cast<std::uint32_t>(launch_params<PoseCost>(context.shape).interpolation) == kInterpolation;
}

template <std::uint32_t kTiles>
bool has_tiles(const VariantContext& context) {
  return (launch_params<PoseBounds>(context.shape).tile_width != 2) == (kTiles == kWideTiles);
}

// ------------------------------------------------------------------------------------------------ the rows

using Suits = bool (*)(const VariantContext&);
using Groups = GroupCount (*)(const LaunchShape&);

/// A group shares the points of one item of the launch.
constexpr ShaderVariant by_groups(const ShaderSource& shader, std::uint32_t group,
                                  std::array<std::uint32_t, 2> constants, Suits suits) {
  return {.shader = shader,
          .local_size = {group, 1, 1},
          .constants = constants,
          .takes_count = true,
          .groups = linear<1>,
          .suits = suits};
}

constexpr ShaderVariant by_cells(const ShaderSource& shader, Groups groups) {
  return {.shader = shader, .local_size = {kGroup, 1, 1}, .groups = groups};
}

constexpr ShaderVariant kVariants[] = {
    by_cells(shader::seed_scatter, linear<kGroup>),
    by_cells(shader::jump_flood_init, grid<JumpFloodInit, 4>),
    by_cells(shader::jump_flood_step, grid<JumpFloodStep, 1>),
    by_cells(shader::jump_flood_distance, grid<JumpFloodDistance, 4>),
    by_cells(shader::distance_field, grid<DistanceField, 4>),
    by_groups(shader::pose_cost, 64, {kNearest, 0}, costs_by<kNearest>),
    by_groups(shader::pose_cost, 64, {kBilinear, 0}, nullptr),
    by_cells(shader::gdt_merge, merged_quads),
    by_cells(shader::field_grow, grown_words),
    by_groups(shader::pose_descent, PoseDescent::kLanes, {0, 0}, nullptr),
    by_cells(shader::sweep_points, linear<kGroup>),
    by_groups(shader::pose_bounds, kGroup, {kSmallTiles, 0}, has_tiles<kSmallTiles>),
    by_groups(shader::pose_bounds, kGroup, {kWideTiles, 0}, nullptr),
    by_cells(shader::gdt_stamp, stamped_quads),
    by_groups(shader::point_to_line, PointToLine::kLanes, {0, 0}, nullptr),
    by_groups(shader::ndt_cost, kNdtGroup, {0, 0}, nullptr),
};

}  // namespace

std::span<const ShaderVariant> shader_variants() { return kVariants; }

std::span<const ShaderVariant> find_variants(std::string_view kernel) {
  const auto all = shader_variants();
  const auto is_of = [kernel](const ShaderVariant& variant) { return variant.shader.name == kernel; };
  const auto begin = std::find_if(all.begin(), all.end(), is_of);
  const auto end = std::find_if_not(begin, all.end(), is_of);
  return {begin, end};
}

std::span<const ShaderModule> shader_modules() {
  static const std::vector<ShaderModule> all = [] {
    std::vector<ShaderModule> modules;
    for (const ShaderVariant& variant : shader_variants()) {
      modules.push_back(
          {.kernel = variant.shader.name,
           .spirv = variant.shader.spirv,
           .local_size = variant.local_size,
           .push_constant_bytes = push_constant_bytes(variant, find_kernel(variant.shader.name)->params_bytes),
           .is_always_suitable = variant.suits == nullptr});
    }
    return modules;
  }();
  return all;
}

}  // namespace gdtslam
