// The layer between our code and Vulkan: hands out the function pointers, counts the calls that can fail, remembers
// which one failed, and fails the k-th on request (VulkanFault). Calls that are not listed in driver_calls.cpp cannot
// be made at all, so none escapes the count.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "api.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

class DriverCalls {
 public:
  DriverCalls(PFN_vkGetInstanceProcAddr entry, const VulkanFault& fault) : entry_(entry), fault_(fault) {}
  DriverCalls(const DriverCalls&) = delete;
  DriverCalls& operator=(const DriverCalls&) = delete;
  ~DriverCalls() = default;

  /// While it lives, this thread's calls of Vulkan go through the layer. Every use of the API stands in such a scope,
  /// destructors of objects apart, which call nothing that can fail.
  class Scope {
   public:
    explicit Scope(DriverCalls& calls);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    DriverCalls* outer_;
  };

  /// Entry point that vk::raii::Context is given.
  static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Name of the last call that failed, "" before.
  [[nodiscard]] std::string_view last_failed() const { return last_failed_; }
  /// Waits for a timeline semaphore past the rehearsed fault, for the end of a backend whose device is in truth alive.
  VkResult wait_past_faults(VkDevice device, const VkSemaphoreWaitInfo& wait, std::uint64_t timeout_ns) const;

  static constexpr std::size_t kMostFunctions = 64;

 private:
  template <std::size_t kIndex, class Pfn>
  friend struct Wrapper;
  static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name);
  static DriverCalls& current();
  /// Counts a call; the code of a rehearsed fault, else VK_SUCCESS.
  VkResult before_call();
  void after_call(std::size_t index, VkResult result);
  PFN_vkVoidFunction wrapped(PFN_vkVoidFunction real, std::string_view name);

  PFN_vkGetInstanceProcAddr entry_;
  PFN_vkGetDeviceProcAddr device_entry_ = nullptr;
  VulkanFault fault_;
  std::uint64_t count_ = 0;
  bool lost_ = false;
  std::string_view last_failed_;
  std::array<PFN_vkVoidFunction, kMostFunctions> real_{};
};

/// The entry of libvulkan.so.1; throws UnavailableError where it is not installed. Thread-safe. The library stays open
/// until the process ends, because drivers leave threads and thread-local destructors behind.
PFN_vkGetInstanceProcAddr vulkan_entry();

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
