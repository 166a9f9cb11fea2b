// What the rows of several kernels compute alike.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "variants.hpp"

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
inline bool fits_loops(const VariantContext& context, std::uint64_t turns) {
  return context.device.kind != "lavapipe" || turns < 65535;
}

/// Whether the variants for CPUs that play a device are wanted: the first of a table, tried before those for GPUs.
inline bool wants_narrow(const VariantContext& context) { return !context.wide(); }

/// Bindings of the kernels that look points up in a field.
inline constexpr int kFieldBinding = 0;
inline constexpr int kPointsBinding = 1;

/// Two tables one after the other; the last variant of all serves whatever is left.
template <std::size_t kCount>
constexpr std::array<ShaderVariant, 2 * kCount> joined(const std::array<ShaderVariant, kCount>& first,
                                                       const std::array<ShaderVariant, kCount>& second) {
  std::array<ShaderVariant, 2 * kCount> all{};
  for (std::size_t i = 0; i < kCount; ++i) {
    all[i] = first[i];
    all[kCount + i] = second[i];
  }
  all.back().suits = nullptr;
  return all;
}

}  // namespace gdtslam
