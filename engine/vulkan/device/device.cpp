#include "device.hpp"

#include <algorithm>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::string device_kind(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual";
    case vk::PhysicalDeviceType::eCpu:
      return "lavapipe";
    default:
      return "other";
  }
}

std::string to_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

std::string driver_text(const vk::PhysicalDeviceDriverProperties& driver) {
  const std::string name = driver.driverName;
  const std::string info = driver.driverInfo;
  return info.empty() ? name : name + " " + info;
}

std::string uuid_text(const vk::PhysicalDeviceIDProperties& ids) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : ids.deviceUUID) {
    text += {kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return text;
}

std::size_t largest_local_heap(const vk::PhysicalDeviceMemoryProperties& memory) {
  vk::DeviceSize largest = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal) {
      largest = std::max(largest, memory.memoryHeaps[i].size);
    }
  }
  return largest;
}

std::string find_problem(const vk::raii::PhysicalDevice& device, std::uint32_t api_version) {
  if (api_version < VK_API_VERSION_1_2) {
    return "offers Vulkan " + to_text(api_version) + ", 1.2 is needed";
  }
  if (!compute_family(device)) {
    return "has no queue that computes";
  }
  const auto features = device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceTimelineSemaphoreFeatures>();
  if (features.get<vk::PhysicalDeviceTimelineSemaphoreFeatures>().timelineSemaphore == VK_FALSE) {
    return "has no timeline semaphores";
  }
  return "";
}

}  // namespace

std::optional<std::uint32_t> compute_family(const vk::raii::PhysicalDevice& device) {
  const std::vector<vk::QueueFamilyProperties> families = device.getQueueFamilyProperties();
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    if (families[i].queueCount > 0 && (families[i].queueFlags & vk::QueueFlagBits::eCompute)) {
      return i;
    }
  }
  return std::nullopt;
}

VulkanDeviceInfo describe(const vk::raii::PhysicalDevice& device, unsigned index) {
  const vk::PhysicalDeviceProperties basic = device.getProperties();
  VulkanDeviceInfo info;
  info.index = index;
  info.name = std::string(basic.deviceName.data());
  info.kind = device_kind(basic.deviceType);
  info.api_version = to_text(basic.apiVersion);
  info.vendor_id = basic.vendorID;
  info.device_id = basic.deviceID;
  info.memory_bytes = largest_local_heap(device.getMemoryProperties());
  info.max_storage_buffer_bytes = basic.limits.maxStorageBufferRange;
  info.max_uniform_buffer_bytes = basic.limits.maxUniformBufferRange;
  info.shared_memory_bytes = basic.limits.maxComputeSharedMemorySize;
  info.max_group_invocations = basic.limits.maxComputeWorkGroupInvocations;
  info.max_push_constant_bytes = basic.limits.maxPushConstantsSize;
  info.problem = find_problem(device, basic.apiVersion);
  if (basic.apiVersion >= VK_API_VERSION_1_2) {
    const auto more = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                            vk::PhysicalDeviceSubgroupProperties, vk::PhysicalDeviceIDProperties>();
    info.uuid = uuid_text(more.get<vk::PhysicalDeviceIDProperties>());
    info.driver = driver_text(more.get<vk::PhysicalDeviceDriverProperties>());
    info.subgroup_size = more.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize;
  }
  const auto family = compute_family(device);
  if (family && device.getQueueFamilyProperties()[*family].timestampValidBits > 0) {
    info.timestamp_ns = static_cast<double>(basic.limits.timestampPeriod);
  }
  return info;
}

VulkanListing list_vulkan_devices() {
  VulkanListing listing;
  try {
    const VulkanInstance instance = make_instance(nullptr);
    for (const vk::raii::PhysicalDevice& device : vk::raii::PhysicalDevices(instance.handle)) {
      listing.devices.push_back(describe(device, static_cast<unsigned>(listing.devices.size())));
    }
    if (listing.devices.empty()) {
      listing.problem =
          "Vulkan finds no device on this machine; VK_LOADER_DEBUG=error in the environment shows what its drivers say";
    }
  } catch (const Error& error) {
    listing.problem = error.what();
  } catch (const vk::SystemError& error) {
    listing.problem = device_error("vulkan", error).what();
  }
  return listing;
}

namespace {

/// "vulkan:0 NAME (KIND)" of each device, for the message that the requested one is missing.
std::string list_devices(const std::vector<VulkanDeviceInfo>& devices) {
  std::string text;
  for (const VulkanDeviceInfo& device : devices) {
    text += (text.empty() ? "" : ", ") + std::string("vulkan:") + std::to_string(device.index) + " " + device.name +
            " (" + device.kind + (device.problem.empty() ? "" : ", " + device.problem) + ")";
  }
  return text.empty() ? "none" : text;
}

std::size_t index_of_first_gpu(const std::vector<VulkanDeviceInfo>& devices) {
  const auto usable = [](const VulkanDeviceInfo& device) { return device.is_hardware() && device.problem.empty(); };
  const auto found = std::find_if(devices.begin(), devices.end(), usable);
  if (found == devices.end()) {
    throw UnavailableError("Vulkan finds no hardware GPU that can be used; devices: " + list_devices(devices));
  }
  return found->index;
}

std::size_t chosen_index(const std::vector<VulkanDeviceInfo>& devices, std::optional<unsigned> wanted) {
  if (!wanted) {
    return index_of_first_gpu(devices);
  }
  if (*wanted >= devices.size()) {
    throw UnavailableError("there is no device vulkan:" + std::to_string(*wanted) +
                           "; devices: " + list_devices(devices));
  }
  if (!devices[*wanted].problem.empty()) {
    throw UnavailableError("device vulkan:" + std::to_string(*wanted) + " " + devices[*wanted].name +
                           " cannot be used: " + devices[*wanted].problem);
  }
  return *wanted;
}

vk::raii::PhysicalDevice choose(const VulkanInstance& instance, const VulkanOptions& options, VulkanDeviceInfo& info) {
  vk::raii::PhysicalDevices all(instance.handle);
  std::vector<VulkanDeviceInfo> devices;
  for (const vk::raii::PhysicalDevice& device : all) {
    devices.push_back(describe(device, static_cast<unsigned>(devices.size())));
  }
  const std::size_t index = chosen_index(devices, options.index);
  info = devices[index];
  if (!options.time_submissions.value_or(info.is_hardware())) {
    info.timestamp_ns = 0.0;
  }
  if (options.edit_device) {
    options.edit_device(info);
  }
  return std::move(all[index]);
}

vk::raii::Device make_device(const vk::raii::PhysicalDevice& physical, std::uint32_t family) {
  const float priority = 1.0F;
  vk::DeviceQueueCreateInfo queue;
  queue.queueFamilyIndex = family;
  queue.setQueuePriorities(priority);
  vk::PhysicalDeviceTimelineSemaphoreFeatures timeline;
  timeline.timelineSemaphore = VK_TRUE;
  vk::DeviceCreateInfo info;
  info.setQueueCreateInfos(queue);
  info.pNext = &timeline;
  return {physical, info};
}

vk::raii::Semaphore make_timeline(const vk::raii::Device& device) {
  vk::SemaphoreTypeCreateInfo type;
  type.semaphoreType = vk::SemaphoreType::eTimeline;
  vk::SemaphoreCreateInfo info;
  info.pNext = &type;
  return {device, info};
}

std::size_t largest_buffer(const vk::raii::PhysicalDevice& physical, const VulkanDeviceInfo& info) {
  const auto more = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceMaintenance3Properties>();
  const auto one_allocation = more.get<vk::PhysicalDeviceMaintenance3Properties>().maxMemoryAllocationSize;
  const std::size_t limit =
      std::min({info.max_storage_buffer_bytes, info.memory_bytes, static_cast<std::size_t>(one_allocation)});
  return limit / 16 * 16;
}

}  // namespace

Device::Device(const VulkanInstance& instance, const VulkanOptions& options)
    : physical_(choose(instance, options, info_)),
      properties_(physical_.getProperties()),
      memory_(physical_.getMemoryProperties()),
      max_buffer_bytes_(largest_buffer(physical_, info_)),
      queue_family_(compute_family(physical_).value()),
      timestamp_bits_(physical_.getQueueFamilyProperties()[queue_family_].timestampValidBits),
      handle_(make_device(physical_, queue_family_)),
      queue_(handle_, queue_family_, 0),
      timeline_(make_timeline(handle_)) {}

}  // namespace gdtslam
