// What is asked of a physical device before it is used.
#pragma once

#include <cstdint>
#include <optional>

#include "api.hpp"
#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

/// Of uniform texel buffers: a texel is a word.
inline constexpr vk::Format kTexelFormat = vk::Format::eR32Uint;

/// Within a DriverCalls::Scope.
VulkanDeviceInfo describe(const vk::raii::PhysicalDevice& device, unsigned index);
/// The queue family that work is given to: the first that computes.
std::optional<std::uint32_t> compute_family(const vk::raii::PhysicalDevice& device);

}  // namespace gdtslam
