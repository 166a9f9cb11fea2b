// The only include of Vulkan in the project. Every function is called through vk::raii's dispatchers, whose pointers
// come from vulkan_entry(); nothing links the Vulkan library.
#pragma once

#define VK_NO_PROTOTYPES 1
#define VULKAN_HPP_DISPATCH_LOADER_DYNAMIC 1
#define VULKAN_HPP_ENABLE_DYNAMIC_LOADER_TOOL 0
#define VULKAN_HPP_NO_SMART_HANDLE 1

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpragmas"
#include <vulkan/vulkan_raii.hpp>
#pragma GCC diagnostic pop
