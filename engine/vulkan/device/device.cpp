#include "device.hpp"

#include <algorithm>

#include "device_info.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// "vulkan:0 NAME (KIND)" of each device, for the message that the one asked for is not there.
std::string list_of(const std::vector<VulkanDeviceInfo>& devices) {
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
    throw UnavailableError("Vulkan finds no hardware GPU that can be used; devices: " + list_of(devices));
  }
  return found->index;
}

std::size_t chosen_index(const std::vector<VulkanDeviceInfo>& devices, std::optional<unsigned> wanted) {
  if (!wanted) {
    return index_of_first_gpu(devices);
  }
  if (*wanted >= devices.size()) {
    throw UnavailableError("there is no device vulkan:" + std::to_string(*wanted) + "; devices: " + list_of(devices));
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
