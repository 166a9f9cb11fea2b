// The Vulkan loader, opened at run time.
#pragma once

#include "api.hpp"

namespace gdtslam {

/// The entry of libvulkan.so.1; throws UnavailableError where it is not installed. Thread-safe. The library stays open
/// until the process ends, because drivers leave threads and thread-local destructors behind.
PFN_vkGetInstanceProcAddr vulkan_entry();

}  // namespace gdtslam
