// Environment variables that change a backend: limits and checks that should need no change of a program.
#pragma once

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

/// The most seconds that a wait may take where nothing else is asked for, and what asks for it.
inline constexpr double kWaitLimit_s = 30.0;
inline constexpr const char* kWaitLimitVariable = "GDTSLAM_VULKAN_WAIT_S";
/// How long a wait for hardware asks before it sleeps.
inline constexpr double kSpin_s = 5.0e-5;

/// The options with the seconds of GDTSLAM_VULKAN_WAIT_S and GDTSLAM_VULKAN_SPIN_S where they have none, and with
/// validation where GDTSLAM_VULKAN_VALIDATION is 1. Throws UsageError for other values.
VulkanOptions with_environment(VulkanOptions options);

}  // namespace gdtslam
