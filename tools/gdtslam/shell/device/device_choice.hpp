// Which device a name stands for: auto, cpu, vulkan or vulkan:N. Values in, values out: nothing is opened here.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

struct DeviceName {
  enum class Kind : std::uint8_t { kAuto, kCpu, kVulkan };
  Kind kind = Kind::kAuto;
  std::optional<unsigned> index;  ///< N of vulkan:N
};

/// Throws UsageError.
DeviceName parse_device_name(const std::string& name);

struct DeviceChoice {
  std::optional<unsigned> index;  ///< of the listing; the CPU when empty
  std::string remark;             ///< what the user should know of it; empty as a rule
};

/// Whether the last `gdtslam verify` of a device found differences, or the device failed in it.
using IsDistrusted = std::function<bool(const VulkanDeviceInfo&)>;

/// auto: the first hardware GPU that can be used and is not distrusted, else the CPU. vulkan: the first hardware GPU
/// that can be used, else the first device of any kind, because Vulkan was named. vulkan:N: that one. Throws
/// UnavailableError where a device was named that is not there or cannot be used.
DeviceChoice choose_device(const DeviceName& name, const VulkanListing& listing, const IsDistrusted& is_distrusted);

}  // namespace gdtslam
