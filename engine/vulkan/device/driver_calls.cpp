#include "driver_calls.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace gdtslam {

/// The function that stands in for one that returns a VkResult.
template <std::size_t kIndex, class Pfn>
struct Wrapper;

template <std::size_t kIndex, class... Arguments>
struct Wrapper<kIndex, VkResult(VKAPI_PTR*)(Arguments...)> {
  static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
    DriverCalls& calls = DriverCalls::current();
    VkResult result = calls.before_call();
    if (result == VK_SUCCESS) {
      result = reinterpret_cast<VkResult(VKAPI_PTR*)(Arguments...)>(calls.real_[kIndex])(arguments...);
    }
    calls.after_call(kIndex, result);
    return result;
  }
};

namespace {

thread_local DriverCalls* current_calls = nullptr;

template <class Pfn>
struct Function {
  std::string_view name;
};

/// Every function that we call and that can fail.
constexpr std::tuple kFallible{
    Function<PFN_vkEnumerateInstanceVersion>{"vkEnumerateInstanceVersion"},
    Function<PFN_vkEnumerateInstanceLayerProperties>{"vkEnumerateInstanceLayerProperties"},
    Function<PFN_vkEnumerateInstanceExtensionProperties>{"vkEnumerateInstanceExtensionProperties"},
    Function<PFN_vkCreateInstance>{"vkCreateInstance"},
    Function<PFN_vkCreateDebugUtilsMessengerEXT>{"vkCreateDebugUtilsMessengerEXT"},
    Function<PFN_vkEnumeratePhysicalDevices>{"vkEnumeratePhysicalDevices"},
    Function<PFN_vkCreateDevice>{"vkCreateDevice"},
    Function<PFN_vkCreateSemaphore>{"vkCreateSemaphore"},
    Function<PFN_vkGetSemaphoreCounterValue>{"vkGetSemaphoreCounterValue"},
    Function<PFN_vkWaitSemaphores>{"vkWaitSemaphores"},
    Function<PFN_vkCreateCommandPool>{"vkCreateCommandPool"},
    Function<PFN_vkResetCommandPool>{"vkResetCommandPool"},
    Function<PFN_vkAllocateCommandBuffers>{"vkAllocateCommandBuffers"},
    Function<PFN_vkBeginCommandBuffer>{"vkBeginCommandBuffer"},
    Function<PFN_vkEndCommandBuffer>{"vkEndCommandBuffer"},
    Function<PFN_vkQueueSubmit>{"vkQueueSubmit"},
    Function<PFN_vkCreateBuffer>{"vkCreateBuffer"},
    Function<PFN_vkCreateBufferView>{"vkCreateBufferView"},
    Function<PFN_vkAllocateMemory>{"vkAllocateMemory"},
    Function<PFN_vkBindBufferMemory>{"vkBindBufferMemory"},
    Function<PFN_vkMapMemory>{"vkMapMemory"},
    Function<PFN_vkCreateShaderModule>{"vkCreateShaderModule"},
    Function<PFN_vkCreateDescriptorSetLayout>{"vkCreateDescriptorSetLayout"},
    Function<PFN_vkCreateDescriptorPool>{"vkCreateDescriptorPool"},
    Function<PFN_vkAllocateDescriptorSets>{"vkAllocateDescriptorSets"},
    Function<PFN_vkCreatePipelineLayout>{"vkCreatePipelineLayout"},
    Function<PFN_vkCreatePipelineCache>{"vkCreatePipelineCache"},
    Function<PFN_vkGetPipelineCacheData>{"vkGetPipelineCacheData"},
    Function<PFN_vkCreateComputePipelines>{"vkCreateComputePipelines"},
    Function<PFN_vkCreateQueryPool>{"vkCreateQueryPool"},
    Function<PFN_vkGetQueryPoolResults>{"vkGetQueryPoolResults"},
};
constexpr std::size_t kFallibleCount = std::tuple_size_v<decltype(kFallible)>;
static_assert(kFallibleCount <= DriverCalls::kMostFunctions);

/// Every function that we call and that returns nothing, besides those that destroy, free or record (vkCmd...).
constexpr std::string_view kInfallible[] = {
    "vkGetPhysicalDeviceProperties",
    "vkGetPhysicalDeviceProperties2",
    "vkGetPhysicalDeviceFeatures2",
    "vkGetPhysicalDeviceFormatProperties",
    "vkGetPhysicalDeviceQueueFamilyProperties",
    "vkGetPhysicalDeviceMemoryProperties",
    "vkGetDeviceQueue",
    "vkGetBufferMemoryRequirements",
    "vkUpdateDescriptorSets",
    "vkUnmapMemory",
};

struct Row {
  std::string_view name;
  PFN_vkVoidFunction wrapper;
};

template <std::size_t kIndex, class Pfn>
Row make_row(const Function<Pfn>& function) {
  return {function.name, reinterpret_cast<PFN_vkVoidFunction>(&Wrapper<kIndex, Pfn>::call)};
}

const std::array<Row, kFallibleCount>& rows() {
  static const auto table = []<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
    return std::array<Row, kFallibleCount>{make_row<kIndices>(std::get<kIndices>(kFallible))...};
  }
  (std::make_index_sequence<kFallibleCount>{});
  return table;
}

bool is_infallible(std::string_view name) {
  return name.starts_with("vkDestroy") || name.starts_with("vkFree") || name.starts_with("vkCmd") ||
         std::find(std::begin(kInfallible), std::end(kInfallible), name) != std::end(kInfallible);
}

VkResult to_result(VulkanFault::Code code) {
  switch (code) {
    case VulkanFault::Code::kOutOfDeviceMemory:
      return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    case VulkanFault::Code::kOutOfHostMemory:
      return VK_ERROR_OUT_OF_HOST_MEMORY;
    case VulkanFault::Code::kDeviceLost:
      break;
  }
  return VK_ERROR_DEVICE_LOST;
}

}  // namespace

DriverCalls::Scope::Scope(DriverCalls& calls) : outer_(std::exchange(current_calls, &calls)) {}
DriverCalls::Scope::~Scope() { current_calls = outer_; }

DriverCalls& DriverCalls::current() {
  assert(current_calls != nullptr && "a call of Vulkan outside of a DriverCalls::Scope");
  return *current_calls;
}

VkResult DriverCalls::before_call() {
  ++count_;
  if (lost_ || count_ == fault_.at) {
    lost_ = lost_ || fault_.code == VulkanFault::Code::kDeviceLost;
    return to_result(fault_.code);
  }
  return VK_SUCCESS;
}

void DriverCalls::after_call(std::size_t index, VkResult result) {
  if (result != VK_SUCCESS) {
    last_failed_ = rows()[index].name;
  }
}

PFN_vkVoidFunction DriverCalls::wrapped(PFN_vkVoidFunction real, std::string_view name) {
  if (real == nullptr || is_infallible(name)) {
    return real;
  }
  const auto& table = rows();
  const auto found = std::find_if(table.begin(), table.end(), [name](const Row& row) { return row.name == name; });
  if (found == table.end()) {
    return nullptr;
  }
  real_[static_cast<std::size_t>(found - table.begin())] = real;
  return found->wrapper;
}

PFN_vkVoidFunction DriverCalls::instance_function(VkInstance instance, const char* name) {
  DriverCalls& calls = current();
  const PFN_vkVoidFunction real = calls.entry_(instance, name);
  if (std::string_view(name) == "vkGetDeviceProcAddr") {
    calls.device_entry_ = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
    return reinterpret_cast<PFN_vkVoidFunction>(&DriverCalls::device_function);
  }
  return calls.wrapped(real, name);
}

PFN_vkVoidFunction DriverCalls::device_function(VkDevice device, const char* name) {
  DriverCalls& calls = current();
  if (std::string_view(name) == "vkGetDeviceProcAddr") {
    return reinterpret_cast<PFN_vkVoidFunction>(&DriverCalls::device_function);
  }
  return calls.wrapped(calls.device_entry_(device, name), name);
}

VkResult DriverCalls::wait_past_faults(VkDevice device, const VkSemaphoreWaitInfo& wait,
                                       std::uint64_t timeout_ns) const {
  const auto& table = rows();
  const auto row = std::find_if(table.begin(), table.end(), [](const Row& r) { return r.name == "vkWaitSemaphores"; });
  const PFN_vkVoidFunction real = real_[static_cast<std::size_t>(row - table.begin())];
  return real == nullptr ? VK_SUCCESS : reinterpret_cast<PFN_vkWaitSemaphores>(real)(device, &wait, timeout_ns);
}

PFN_vkGetInstanceProcAddr vulkan_entry() {
  void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw UnavailableError(
        "the Vulkan loader libvulkan.so.1 cannot be opened; install it (Debian package libvulkan1) or use the CPU");
  }
  const auto entry = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library, "vkGetInstanceProcAddr"));
  if (entry == nullptr) {
    throw UnavailableError("libvulkan.so.1 has no vkGetInstanceProcAddr, so it is no Vulkan loader");
  }
  return entry;
}

void check(VkResult result, const char* call) {
  if (result != VK_SUCCESS) {
    throw vk::SystemError(vk::make_error_code(static_cast<vk::Result>(result)), call);
  }
}

}  // namespace gdtslam
