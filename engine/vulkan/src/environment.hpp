// What the environment may change about a backend: rehearsals and checks that should need no change of a program.
#pragma once

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

/// The options with GDTSLAM_VULKAN_FAULT ("17:device-lost", "...:out-of-device-memory", "...:out-of-host-memory") where
/// they rehearse no fault themselves, and with validation where GDTSLAM_VULKAN_VALIDATION is 1. Throws UsageError for
/// other values.
VulkanOptions with_environment(VulkanOptions options);

}  // namespace gdtslam
