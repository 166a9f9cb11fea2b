// Checks the requirements of a physical device, and creates the logical device with its queue and its timeline, which
// shows the queue's progress.
#pragma once

#include <cstdint>
#include <optional>

#include "gdtslam/vulkan/vulkan.hpp"
#include "instance.hpp"

namespace gdtslam {

VulkanDeviceInfo describe(const vk::raii::PhysicalDevice& device, unsigned index);
/// The queue family for the work: the first with compute.
std::optional<std::uint32_t> compute_family(const vk::raii::PhysicalDevice& device);

class Device {
 public:
  /// Throws UnavailableError if there is no such device.
  Device(const VulkanInstance& instance, const VulkanOptions& options);

  [[nodiscard]] const VulkanDeviceInfo& info() const { return info_; }
  [[nodiscard]] const vk::PhysicalDeviceProperties& properties() const { return properties_; }
  [[nodiscard]] const vk::raii::Device& handle() const { return handle_; }
  [[nodiscard]] const vk::raii::Queue& queue() const { return queue_; }
  [[nodiscard]] const vk::raii::Semaphore& timeline() const { return timeline_; }
  [[nodiscard]] std::uint32_t queue_family() const { return queue_family_; }
  [[nodiscard]] std::uint32_t timestamp_bits() const { return timestamp_bits_; }
  [[nodiscard]] std::size_t max_buffer_bytes() const { return max_buffer_bytes_; }
  [[nodiscard]] const vk::PhysicalDeviceMemoryProperties& memory() const { return memory_; }

 private:
  VulkanDeviceInfo info_;
  vk::raii::PhysicalDevice physical_;
  vk::PhysicalDeviceProperties properties_;
  vk::PhysicalDeviceMemoryProperties memory_;
  std::size_t max_buffer_bytes_ = 0;
  std::uint32_t queue_family_ = 0;
  std::uint32_t timestamp_bits_ = 0;
  vk::raii::Device handle_;
  vk::raii::Queue queue_;
  vk::raii::Semaphore timeline_;
};

}  // namespace gdtslam
