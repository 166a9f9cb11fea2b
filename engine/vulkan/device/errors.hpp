// From what Vulkan reports to the project's typed errors.
#pragma once

#include <string>

#include "driver_calls.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// Runs `action` with its calls of Vulkan going through the layer; what they throw becomes DeviceError.
template <class Action>
decltype(auto) with_driver(DriverCalls& calls, const std::string& device, Action&& action) {
  const DriverCalls::Scope scope(calls);
  try {
    return std::forward<Action>(action)();
  } catch (const vk::SystemError& error) {
    throw DeviceError(device, std::string(calls.last_failed()),
                      vk::to_string(static_cast<vk::Result>(error.code().value())));
  }
}

/// Throws what vk::raii would have thrown, for the calls that are made without it.
void check(VkResult result, const char* call);

}  // namespace gdtslam
