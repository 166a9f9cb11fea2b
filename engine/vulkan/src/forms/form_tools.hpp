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

/// Points that a uniform buffer of the size that every device allows takes.
inline constexpr std::uint32_t kUniformPoints = 2048;

/// Whether an invocation may take so many turns of loops, all its loops together. lavapipe leaves every loop after its
/// first turn once an invocation has taken 65,535 (measured, Mesa 22.3), and says nothing.
inline bool fits_loops(const FormContext& context, std::uint64_t turns) {
  return context.device.kind != "lavapipe" || turns < 65535;
}

inline bool wants_wide(const FormContext& context) { return context.wide(); }

}  // namespace gdtslam
