// The connection to Vulkan, with the validation layers where they are asked for.
#pragma once

#include "api.hpp"
#include "validation_log.hpp"

namespace gdtslam {

struct VulkanInstance {
  vk::raii::Context context;
  vk::raii::Instance handle;
  vk::raii::DebugUtilsMessengerEXT messenger;
};

/// Within a DriverCalls::Scope. Throws UnavailableError when there is no driver, when the loader is older than Vulkan
/// 1.2, or when `log` is given (validation and synchronisation validation are wanted) and the layer is not installed.
/// The log must outlive the instance.
VulkanInstance make_instance(ValidationLog* log);

}  // namespace gdtslam
