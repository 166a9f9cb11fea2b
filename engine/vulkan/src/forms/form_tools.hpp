// What the rows of several kernels compute alike.
#pragma once

#include <cstdint>
#include <cstring>

#include "forms/forms.hpp"

namespace gdtslam {

/// The parameters of a launch of kernel K.
template <class K>
typename K::Params launch_params(const LaunchShape& shape) {
  typename K::Params params;
  std::memcpy(&params, shape.params.data(), sizeof(params));
  return params;
}

/// Groups that cover `count` things, `per_group` each.
inline GroupCount groups_for(std::uint64_t count, std::uint32_t per_group) {
  return folded((count + per_group - 1) / per_group);
}

/// Invocations of a group that every device runs, of however few it is capable.
inline constexpr std::uint32_t kEveryDevicesGroup = 128;

/// Points that a uniform buffer of the size that every device allows takes.
inline constexpr std::uint32_t kUniformPoints = 2048;

/// Whether an invocation may take so many turns of loops, all its loops together. lavapipe leaves every loop after its
/// first turn once an invocation has taken 65,535 (measured, Mesa 22.3), and says nothing.
inline bool fits_loops(const FormContext& context, std::uint64_t turns) {
  return context.device.kind != "lavapipe" || turns < 65535;
}

/// A form with another shader, which reads the field, binding 0 of the kernels that have one, as texels.
constexpr ShaderForm with_texels(ShaderForm form, std::string_view name, std::span<const std::uint32_t> spirv) {
  form.name = name;
  form.spirv = spirv;
  form.texel_binding = 0;
  return form;
}

inline bool wants_wide(const FormContext& context) { return context.wide(); }

}  // namespace gdtslam
