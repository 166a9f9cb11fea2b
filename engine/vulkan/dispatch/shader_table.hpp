// Choice of the shader for a kernel on a device. The source holds the rows of all kernels, their group sizes and the
// rules of the choice.
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

/// Inputs for the choice of a variant.
struct VariantContext {
  const VulkanDeviceInfo& device;
  const LaunchShape& shape;
};

/// A shader of the build: gdtslam::shader::<stem> in the header generated from each file of shaders/.
struct ShaderSource {
  std::string_view name;  ///< stem of the file, equal to the kernel's name
  std::span<const std::uint32_t> spirv;
};

struct ShaderVariant {
  ShaderSource shader;
  std::array<std::uint32_t, 3> local_size;             ///< specialisation constants 0, 1, 2
  std::array<std::uint32_t, 2> constants{};            ///< specialisation constants 10, 11 if the shader has them
  bool takes_count = false;                            ///< the launch's extent along x is one more push constant
  GroupCount (*groups)(const LaunchShape&) = nullptr;  ///< work groups of a launch; x, y at most 65535
  bool (*suits)(const VariantContext&) = nullptr;      ///< nullptr: always
};

/// Bytes of a variant's push constants for parameters of that size.
inline std::uint32_t push_constant_bytes(const ShaderVariant& variant, std::size_t params_bytes) {
  return static_cast<std::uint32_t>(params_bytes + (variant.takes_count ? sizeof(std::uint32_t) : 0));
}

/// All rows, grouped by kernel in the order of the registry; the first suitable row of a kernel is chosen, and its last
/// row always suits.
std::span<const ShaderVariant> shader_variants();
/// The rows of one kernel; empty if the build has no shader for it.
std::span<const ShaderVariant> find_variants(std::string_view kernel);

}  // namespace gdtslam
