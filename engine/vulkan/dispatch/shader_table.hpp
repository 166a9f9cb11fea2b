// Which shader serves a kernel on a device: one row per shader, in files variants/<kernel>.cpp, so that a kernel's
// variants, their group sizes and the rule that chooses between them stand together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

struct GroupCount {
  std::uint32_t x = 1;
  std::uint32_t y = 1;
  std::uint32_t z = 1;
};

/// What the choice of a variant may look at.
struct VariantContext {
  const VulkanDeviceInfo& device;
  ShaderVariants preference;
  const LaunchShape& shape;
  /// Whether the variants for GPUs are wanted: asked for, or by the device.
  [[nodiscard]] bool wide() const {
    return preference == ShaderVariants::kWide ||
           (preference == ShaderVariants::kByDevice && device.kind != "lavapipe");
  }
};

struct ShaderVariant {
  std::string_view kernel;  ///< name in the registry
  std::string_view name;    ///< stem of its file in shaders/
  std::span<const std::uint32_t> spirv;
  std::array<std::uint32_t, 3> local_size;   ///< specialisation constants 0, 1, 2
  std::array<std::uint32_t, 2> constants{};  ///< specialisation constants 10, 11 where the shader has them
  int uniform_binding = -1;                  ///< the binding that is a uniform buffer; -1: none
  /// The binding that is a uniform texel buffer of 32-bit words; -1: none. The variant serves buffers that the device
  /// takes as such; a variant without must stand behind it for the others.
  int texel_binding = -1;
  bool takes_count = false;  ///< the launch's extent along x follows the parameters as one more push constant
  GroupCount (*groups)(const LaunchShape&) = nullptr;  ///< work groups of a launch; x, y at most 65535
  bool (*suits)(const VariantContext&) = nullptr;      ///< nullptr: always
};

/// Bytes of push constants that a variant takes for parameters of that size.
inline std::uint32_t push_constant_bytes(const ShaderVariant& variant, std::size_t params_bytes) {
  return static_cast<std::uint32_t>(params_bytes + (variant.takes_count ? sizeof(std::uint32_t) : 0));
}

/// All rows, grouped by kernel; the first row of a kernel that suits is taken, and its last row always does.
std::span<const ShaderVariant> shader_variants();
/// The rows of one kernel; none when the build has no shader for it.
std::span<const ShaderVariant> variants_of(std::string_view kernel);

/// Groups of a one-dimensional launch of `count` groups: folded into rows of at most 65535, so a shader's linear group
/// is gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x and may be beyond the count.
GroupCount folded(std::uint64_t count);

}  // namespace gdtslam
