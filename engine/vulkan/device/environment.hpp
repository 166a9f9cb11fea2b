// Environment variables for a backend's limits and checks, which need no change of the program.
#pragma once

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

/// Default limit of a wait, in seconds.
inline constexpr double kWaitLimit_s = 30.0;
inline constexpr const char* kWaitLimitVariable = "GDTSLAM_VULKAN_WAIT_S";
/// Polling time of a wait for hardware before it sleeps.
inline constexpr double kSpin_s = 5.0e-5;

/// Fills empty options from GDTSLAM_VULKAN_WAIT_S and GDTSLAM_VULKAN_SPIN_S (seconds), and enables validation if
/// GDTSLAM_VULKAN_VALIDATION is 1. Throws UsageError for other values.
VulkanOptions with_environment(VulkanOptions options);

}  // namespace gdtslam
