// Which shader serves a kernel on a device. The rows of all kernels, their group sizes and the rules that choose
// between them stand together in the source.
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

/// Values that the choice of a variant depends on.
struct VariantContext {
  const VulkanDeviceInfo& device;
  const LaunchShape& shape;
};

/// A shader of the build: gdtslam::shader::<stem> in the header that the build makes of each file of shaders/.
struct ShaderSource {
  std::string_view name;  ///< stem of its file, the name of its kernel
  std::span<const std::uint32_t> spirv;
};

struct ShaderVariant {
  ShaderSource shader;
  std::array<std::uint32_t, 3> local_size;   ///< specialisation constants 0, 1, 2
  std::array<std::uint32_t, 2> constants{};  ///< specialisation constants 10, 11 where the shader has them
  bool takes_count = false;  ///< the launch's extent along x follows the parameters as one more push constant
  GroupCount (*groups)(const LaunchShape&) = nullptr;  ///< work groups of a launch; x, y at most 65535
  bool (*suits)(const VariantContext&) = nullptr;      ///< nullptr: always
};

/// Bytes of push constants that a variant takes for parameters of that size.
inline std::uint32_t push_constant_bytes(const ShaderVariant& variant, std::size_t params_bytes) {
  return static_cast<std::uint32_t>(params_bytes + (variant.takes_count ? sizeof(std::uint32_t) : 0));
}

/// All rows, grouped by kernel in the order of the registry; the first row of a kernel that suits is taken, and its
/// last row always does.
std::span<const ShaderVariant> shader_variants();
/// The rows of one kernel; none when the build has no shader for it.
std::span<const ShaderVariant> find_variants(std::string_view kernel);

}  // namespace gdtslam
