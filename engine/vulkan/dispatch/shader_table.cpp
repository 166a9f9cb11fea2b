// Which shader serves which launch on which device: the rows of every kernel, in the order of the registry. The first
// row that suits is taken: those for CPUs that play a device come first, and the last row of a kernel always suits.
#include "shader_table.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "shaders.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  // of one dimension, on every device

/// The parameters of a launch of kernel K.
template <class K>
typename K::Params launch_params(const LaunchShape& shape) {
  typename K::Params params;
  std::memcpy(&params, shape.params.data(), sizeof(params));
  return params;
}

constexpr std::uint64_t divided_up(std::uint64_t count, std::uint64_t part) { return (count + part - 1) / part; }

// ------------------------------------------------------------------------------------------------ numbers of groups

/// Groups that cover `count` things, `per_group` each: folded into rows of at most 65535, so a shader's linear group is
/// gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x and may be beyond the count.
GroupCount groups_for(std::uint64_t count, std::uint32_t per_group) {
  const std::uint64_t groups = divided_up(count, per_group);
  const std::uint64_t rows = std::max<std::uint64_t>(1, divided_up(groups, kMostGroups));
  return {static_cast<std::uint32_t>(std::min<std::uint64_t>(groups, kMostGroups)), static_cast<std::uint32_t>(rows),
          1};
}

/// Groups of a grid launch: along x they cover `columns` things, along y `rows` rows, `rows_each` an invocation. A
/// shader goes on by the launch's rows where that leaves some (launch_rows() in shaders/common/launch.glsl), so any
/// number of rows is covered.
GroupCount grid_groups(std::uint64_t columns, std::uint32_t group_columns, std::uint32_t rows,
                       std::uint32_t rows_each) {
  return {static_cast<std::uint32_t>(divided_up(columns, group_columns)),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(divided_up(rows, rows_each), kMostGroups)), 1};
}

GroupCount one_group(const LaunchShape& /*shape*/) { return {}; }

template <std::uint32_t kPerGroup>
GroupCount linear(const LaunchShape& shape) {
  return groups_for(shape.threads.x, kPerGroup);
}

/// Of a kernel that goes through its grid, `kCellsEach` neighbours of `kRowsEach` rows an invocation.
template <class K, std::uint32_t kCellsEach, std::uint32_t kGroup, std::uint32_t kRowsEach>
GroupCount grid(const LaunchShape& shape) {
  const auto params = launch_params<K>(shape);
  return grid_groups(divided_up(params.width, kCellsEach), kGroup, params.height, kRowsEach);
}

/// The quads of the global field's row that the scan's field touches.
template <std::uint32_t kQuads, std::uint32_t kRowsEach>
GroupCount merged_quads(const LaunchShape& shape) {
  const auto params = launch_params<GdtMerge>(shape);
  const std::uint64_t end = divided_up(std::uint64_t{params.offset_x} + params.scan_width, 4);
  return grid_groups(end - params.offset_x / 4, kQuads, params.scan_height, kRowsEach);
}

/// Quads of all tiles that are stamped.
template <std::uint32_t kGroup>
GroupCount stamped_quads(const LaunchShape& shape) {
  return groups_for(std::uint64_t{shape.threads.x} * (kStampTile * kStampTile / 4), kGroup);
}

/// Words of two cells of the new field, `kWords` of a row an invocation.
template <std::uint32_t kWords, std::uint32_t kGroup>
GroupCount grown_words(const LaunchShape& shape) {
  const auto params = launch_params<FieldGrow>(shape);
  return groups_for(divided_up(divided_up(params.width, 2), kWords) * params.height, kGroup);
}

/// Samples of a window's row, `kPiece` an invocation: a column of nine is loaded once a sample, and two more columns
/// once an invocation.
template <std::uint32_t kPiece, std::uint32_t kGroup>
GroupCount row_pieces(const LaunchShape& shape) {
  const auto params = launch_params<LatticeMinima>(shape);
  return groups_for(divided_up(params.count_xy, kPiece) * params.count_xy * params.count_theta, kGroup);
}

// ------------------------------------------------------------------------------------------------ which row suits

/// Whether an invocation may take so many turns of loops, all its loops together. lavapipe leaves every loop after its
/// first turn once an invocation has taken 65,535 (measured, Mesa 22.3), and says nothing.
bool fits_loops(const VariantContext& context, std::uint64_t turns) {
  return context.device.kind != "lavapipe" || turns < 65535;
}

/// Whether the variants for CPUs that play a device are wanted.
bool wants_narrow(const VariantContext& context) { return !context.wide(); }

/// Points that a uniform buffer of the size that every device allows takes.
constexpr std::uint32_t kUniformPoints = 16384 / sizeof(PointCells);
constexpr std::uint32_t kUniformBoundPoints = 16384 / sizeof(BoundPoint);

/// Bindings of the kernels that look points up in a field.
constexpr int kFieldBinding = 0;
constexpr int kPointsBinding = 1;

// What is a constant of the shaders stands in the rows as a number: 0 and 1.
constexpr std::uint32_t kBilinear = static_cast<std::uint32_t>(Interpolation::kBilinear);
constexpr std::uint32_t kNearest = static_cast<std::uint32_t>(Interpolation::kNearest);
constexpr std::uint32_t kSmallTiles = 0;
constexpr std::uint32_t kWideTiles = 1;  // of 16 x 4 boxes

template <std::uint32_t kInterpolation>
bool costs_by(const VariantContext& context) {
  return static_cast<std::uint32_t>(launch_params<PoseCost>(context.shape).interpolation) == kInterpolation;
}
template <std::uint32_t kInterpolation>
bool costs_few_points(const VariantContext& context) {
  return wants_narrow(context) && costs_by<kInterpolation>(context) &&
         launch_params<PoseCost>(context.shape).point_count <= kUniformPoints;
}

template <std::uint32_t kTiles>
bool has_tiles(const VariantContext& context) {
  return (launch_params<PoseBounds>(context.shape).tile_width != 2) == (kTiles == kWideTiles);
}
template <std::uint32_t kTiles>
bool bounds_few_points(const VariantContext& context) {
  return wants_narrow(context) && has_tiles<kTiles>(context) &&
         launch_params<PoseBounds>(context.shape).point_count <= kUniformBoundPoints;
}

template <std::uint32_t kInterpolation>
bool descends_by(const VariantContext& context) {
  return static_cast<std::uint32_t>(launch_params<PoseSimplex>(context.shape).cost.interpolation) == kInterpolation;
}

constexpr std::uint32_t kDescentGroup = 128;
/// The group for descents so long that a device which ends loops needs many invocations, and points a turn of its loop.
constexpr std::uint32_t kLongDescentGroup = 1024;
constexpr std::uint32_t kPointsATurn = 16;

/// Whether `turns` turns of a loop for each pose that is costed are few enough.
bool fits_descent(const VariantContext& context, std::uint32_t turns) {
  // The last move costs up to five poses beyond the limit.
  const std::uint64_t evaluations = std::uint64_t{launch_params<PoseSimplex>(context.shape).max_evaluations} + 5;
  return fits_loops(context, evaluations * (turns + 1));
}
static_assert((PoseSimplex::kMostEvaluations + 5) * (65537U / (kLongDescentGroup * kPointsATurn) + 2) < 65535,
              "the largest group takes every descent");

/// Whether an invocation a pose, which goes through all points, takes them and not too many turns.
template <std::uint32_t kInterpolation>
bool descends_alone(const VariantContext& context) {
  const std::uint32_t points = launch_params<PoseSimplex>(context.shape).cost.point_count;
  return wants_narrow(context) && descends_by<kInterpolation>(context) && points <= kUniformPoints &&
         fits_descent(context, points / 8 + 8);
}

/// Whether a group of the usual size would take too many turns.
template <std::uint32_t kInterpolation>
bool descends_long(const VariantContext& context) {
  const std::uint32_t points = launch_params<PoseSimplex>(context.shape).cost.point_count;
  return descends_by<kInterpolation>(context) && !fits_descent(context, points / kDescentGroup + 1);
}

constexpr std::uint32_t kFewInvocations = 8;
constexpr std::uint32_t kManyInvocations = 1024;

/// Whether few invocations do not take too many turns of their loops: two a block of sixteen values, and the merge.
bool picks_by_few(const VariantContext& context) {
  const std::uint64_t blocks = launch_params<SmallestValues>(context.shape).count / (kFewInvocations * 16);
  return wants_narrow(context) && fits_loops(context, 2 * blocks + 1000);
}

bool takes_many(const VariantContext& context) { return context.device.max_group_invocations >= kManyInvocations; }

/// Few invocations suit a CPU, unless each would take too many turns: one pose of eight, or two or three of more,
/// through all points.
bool chooses_by_few(const VariantContext& context) {
  const auto params = launch_params<ChoosePose>(context.shape);
  const std::uint64_t poses_each = divided_up(params.pose_count, kFewInvocations);
  return wants_narrow(context) && fits_loops(context, poses_each * (params.cost.point_count + 1) + 100);
}

// ------------------------------------------------------------------------------------------------ the rows

using Suits = bool (*)(const VariantContext&);
using Groups = GroupCount (*)(const LaunchShape&);

/// An invocation goes through all points, for CPUs; `kind` is a constant of the shader.
constexpr ShaderVariant by_points(const ShaderSource& shader, std::uint32_t kind, Groups groups, Suits suits) {
  return {.shader = shader,
          .local_size = {8, 1, 1},
          .constants = {kind, 0},
          .uniform_binding = kPointsBinding,
          .texel_binding = kFieldBinding,
          .takes_count = true,
          .groups = groups,
          .suits = suits};
}

/// A group shares the points out; it has one thing of the launch to do.
constexpr ShaderVariant by_groups(const ShaderSource& shader, std::uint32_t group,
                                  std::array<std::uint32_t, 2> constants, Suits suits) {
  return {.shader = shader,
          .local_size = {group, 1, 1},
          .constants = constants,
          .takes_count = true,
          .groups = linear<1>,
          .suits = suits};
}

constexpr ShaderVariant one_size(const ShaderSource& shader, std::uint32_t group, Groups groups, Suits suits = nullptr,
                                 std::uint32_t constant = 0) {
  return {.shader = shader, .local_size = {group, 1, 1}, .constants = {constant, 0}, .groups = groups, .suits = suits};
}

constexpr ShaderVariant kVariants[] = {
    one_size(shader::edt_columns, 8, grid<EdtColumns, 4, 8, 256>, wants_narrow, 256),
    one_size(shader::edt_columns, 64, grid<EdtColumns, 4, 64, 16>, nullptr, 16),
    one_size(shader::edt_rows_narrow, 16, grid<EdtRows, 8, 16, 16>, wants_narrow),
    one_size(shader::edt_rows_wide, 128, grid<EdtRows, 2, 128, 1>),
    one_size(shader::jump_flood_init, 32, grid<JumpFloodInit, 4, 32, 16>, wants_narrow),
    one_size(shader::jump_flood_init, 128, grid<JumpFloodInit, 4, 128, 1>),
    one_size(shader::jump_flood_step, 32, grid<JumpFloodStep, 1, 32, 16>, wants_narrow),
    one_size(shader::jump_flood_step, 128, grid<JumpFloodStep, 1, 128, 1>),
    one_size(shader::jump_flood_distance, 32, grid<JumpFloodDistance, 4, 32, 16>, wants_narrow),
    one_size(shader::jump_flood_distance, 128, grid<JumpFloodDistance, 4, 128, 1>),
    one_size(shader::distance_field, 32, grid<DistanceField, 4, 32, 16>, wants_narrow),
    one_size(shader::distance_field, 128, grid<DistanceField, 4, 128, 1>),
    // Four candidates an invocation.
    by_points(shader::pose_cost_narrow, kNearest, linear<8 * 4>, costs_few_points<kNearest>),
    by_groups(shader::pose_cost_wide, 64, {kNearest, 0}, costs_by<kNearest>),
    by_points(shader::pose_cost_narrow, kBilinear, linear<8 * 4>, costs_few_points<kBilinear>),
    by_groups(shader::pose_cost_wide, 64, {kBilinear, 0}, nullptr),
    one_size(shader::gdt_merge, 32, merged_quads<32, 16>, wants_narrow),
    one_size(shader::gdt_merge, 128, merged_quads<128, 1>),
    // Eight samples an invocation on a CPU, where a group costs more than a sample.
    one_size(shader::pose_lattice, 64, linear<64 * 8>, wants_narrow, 8),
    one_size(shader::pose_lattice, 128, linear<128>, nullptr, 1),
    one_size(shader::lattice_minima, 64, row_pieces<16, 64>, wants_narrow, 16),
    one_size(shader::lattice_minima, 64, row_pieces<4, 64>, nullptr, 4),
    one_size(shader::smallest_values, kFewInvocations, one_group, picks_by_few),
    one_size(shader::smallest_values, kManyInvocations, one_group, takes_many),
    one_size(shader::smallest_values, 128, one_group),
    one_size(shader::seed_scatter, 64, linear<64>),
    one_size(shader::field_grow, 64, grown_words<16, 64>, wants_narrow, 16),
    one_size(shader::field_grow, 64, grown_words<1, 64>, nullptr, 1),
    {.shader = shader::pose_starts, .local_size = {32, 1, 1}, .takes_count = true, .groups = linear<32>},
    by_points(shader::pose_simplex_narrow, kNearest, linear<8>, descends_alone<kNearest>),
    by_groups(shader::pose_simplex_wide, kLongDescentGroup, {kNearest, kPointsATurn}, descends_long<kNearest>),
    by_groups(shader::pose_simplex_wide, kDescentGroup, {kNearest, 1}, descends_by<kNearest>),
    by_points(shader::pose_simplex_narrow, kBilinear, linear<8>, descends_alone<kBilinear>),
    by_groups(shader::pose_simplex_wide, kLongDescentGroup, {kBilinear, kPointsATurn}, descends_long<kBilinear>),
    by_groups(shader::pose_simplex_wide, kDescentGroup, {kBilinear, 1}, nullptr),
    one_size(shader::choose_pose, kFewInvocations, one_group, chooses_by_few),
    one_size(shader::choose_pose, 128, one_group),
    // Eight beams an invocation on a CPU.
    one_size(shader::sweep_points, 32, linear<32 * 8>, wants_narrow, 8),
    one_size(shader::sweep_points, 128, linear<128>, nullptr, 1),
    by_points(shader::pose_bounds_narrow, kSmallTiles, linear<8>, bounds_few_points<kSmallTiles>),
    by_groups(shader::pose_bounds_wide, 128, {kSmallTiles, 0}, has_tiles<kSmallTiles>),
    by_points(shader::pose_bounds_narrow, kWideTiles, linear<8>, bounds_few_points<kWideTiles>),
    by_groups(shader::pose_bounds_wide, 128, {kWideTiles, 0}, nullptr),
    one_size(shader::gdt_stamp, 32, stamped_quads<32>, wants_narrow),
    one_size(shader::gdt_stamp, 128, stamped_quads<128>),
};

}  // namespace

std::span<const ShaderVariant> shader_variants() { return kVariants; }

std::span<const ShaderVariant> variants_of(std::string_view kernel) {
  const auto all = shader_variants();
  const auto is_of = [kernel](const ShaderVariant& variant) { return variant.shader.kernel() == kernel; };
  const auto begin = std::find_if(all.begin(), all.end(), is_of);
  const auto end = std::find_if_not(begin, all.end(), is_of);
  return {begin, end};
}

std::span<const ShaderModule> shader_modules() {
  static const std::vector<ShaderModule> all = [] {
    std::vector<ShaderModule> modules;
    for (const ShaderVariant& variant : shader_variants()) {
      const std::string_view kernel = variant.shader.kernel();
      modules.push_back({.kernel = kernel,
                         .name = variant.shader.name,
                         .spirv = variant.shader.spirv,
                         .local_size = variant.local_size,
                         .uniform_binding = variant.uniform_binding,
                         .texel_binding = variant.texel_binding,
                         .push_constant_bytes = push_constant_bytes(variant, find_kernel(kernel)->params_bytes),
                         .is_always_suitable = variant.suits == nullptr});
    }
    return modules;
  }();
  return all;
}

}  // namespace gdtslam
