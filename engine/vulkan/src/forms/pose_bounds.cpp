#include "gdtslam/compute/kernels/pose_bounds.hpp"

#include <algorithm>

#include "forms/form_tools.hpp"

namespace gdtslam {
namespace {

constexpr int kPoints = 1;  // their binding
/// Points that a uniform buffer of the size that every device allows takes.
constexpr std::uint32_t kUniformBoundPoints = 16384 / sizeof(BoundPoint);

/// Whether tiles are of 16 x 4 boxes, which is a constant of the shaders.
enum class TileShape : std::uint32_t { kSmall = 0, kWide = 1 };

template <TileShape kShape>
bool has_shape(const FormContext& context) {
  return (launch_params<PoseBounds>(context.shape).tile_width != 2) == (kShape == TileShape::kWide);
}

template <TileShape kShape>
bool is_wide(const FormContext& context) {
  return context.wide() && has_shape<kShape>(context);
}

template <TileShape kShape>
bool has_few_points(const FormContext& context) {
  return launch_params<PoseBounds>(context.shape).point_count <= kUniformBoundPoints && has_shape<kShape>(context);
}

GroupCount group_a_tile(const LaunchShape& shape) { return groups_for(shape.threads.x, 1); }

constexpr std::uint32_t kNarrowGroup = 8;
GroupCount narrow_groups(const LaunchShape& shape) { return groups_for(shape.threads.x, kNarrowGroup); }

template <TileShape kShape>
constexpr ShaderForm form(std::string_view name, std::span<const std::uint32_t> spirv) {
  return {.kernel = "pose_bounds",
          .name = name,
          .spirv = spirv,
          .local_size = {kNarrowGroup, 1, 1},
          .constants = {static_cast<std::uint32_t>(kShape), 0},
          .takes_count = true,
          .groups = narrow_groups,
          .suits = has_shape<kShape>};
}

/// The forms for tiles of one shape.
template <TileShape kShape>
constexpr std::array<ShaderForm, 5> forms() {
  ShaderForm wide = form<kShape>("pose_bounds_wide", shader::pose_bounds_wide_spirv);
  wide.local_size = {128, 1, 1};
  wide.groups = group_a_tile;
  wide.suits = is_wide<kShape>;
  ShaderForm few = form<kShape>("pose_bounds_narrow_uniform", shader::pose_bounds_narrow_uniform_spirv);
  few.uniform_binding = kPoints;
  few.suits = has_few_points<kShape>;
  const ShaderForm few_texel =
      with_texels(few, "pose_bounds_narrow_uniform_texel", shader::pose_bounds_narrow_uniform_texel_spirv);
  const ShaderForm many = form<kShape>("pose_bounds_narrow_storage", shader::pose_bounds_narrow_storage_spirv);
  const ShaderForm many_texel =
      with_texels(many, "pose_bounds_narrow_storage_texel", shader::pose_bounds_narrow_storage_texel_spirv);
  return {wide, few_texel, few, many_texel, many};
}

constexpr auto all_forms() {
  constexpr auto kSmall = forms<TileShape::kSmall>();
  std::array<ShaderForm, 2 * kSmall.size()> all{};
  std::copy(kSmall.begin(), kSmall.end(), all.begin());
  constexpr auto kWide = forms<TileShape::kWide>();
  std::copy(kWide.begin(), kWide.end(), all.begin() + kSmall.size());
  all.back().suits = nullptr;
  return all;
}

constexpr auto kForms = all_forms();

}  // namespace

std::span<const ShaderForm> pose_bounds_forms() { return kForms; }

}  // namespace gdtslam
