#include "device_choice.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostDigits = 4;

[[noreturn]] void refuse(const std::string& name) {
  const std::vector<std::string> names{"auto", "cpu", "vulkan"};
  const bool is_gpu = name.starts_with("gpu") || name.starts_with("GPU");  // by its letters it is nearer to cpu
  throw UsageError("--device: there is no device '" + name + "'" + did_you_mean(is_gpu ? "vulkan" : name, names) +
                   " (auto, cpu, vulkan or vulkan:N)");
}

unsigned index_from(std::string_view digits, const std::string& name) {
  if (digits.empty() || digits.size() > kMostDigits || digits.find_first_not_of("0123456789") != digits.npos) {
    refuse(name);
  }
  unsigned index = 0;
  for (const char digit : digits) index = index * 10 + static_cast<unsigned>(digit - '0');
  return index;
}

std::string to_string(const DeviceName& name) {
  return name.index ? fmt::format("vulkan:{}", *name.index) : std::string("vulkan");
}

std::string all_of(const VulkanListing& listing) {
  std::string text;
  for (const VulkanDeviceInfo& device : listing.devices) {
    text += fmt::format("{}vulkan:{} ({}{}{})", text.empty() ? "" : ", ", device.index, device.name,
                        device.problem.empty() ? "" : ": ", device.problem);
  }
  return text;
}

const VulkanDeviceInfo* numbered(const VulkanListing& listing, unsigned index) {
  for (const VulkanDeviceInfo& device : listing.devices) {
    if (device.index == index) return &device;
  }
  return nullptr;
}

const VulkanDeviceInfo* first_usable(const VulkanListing& listing, bool hardware_only) {
  for (const VulkanDeviceInfo& device : listing.devices) {
    if (device.problem.empty() && (device.is_hardware() || !hardware_only)) return &device;
  }
  return nullptr;
}

[[noreturn]] void fail(const DeviceName& name, const std::string& why) {
  throw UnavailableError("--device " + to_string(name) + ": " + why + "; --device cpu gives the same results");
}

unsigned named_device(const DeviceName& name, const VulkanListing& listing) {
  if (listing.devices.empty()) throw UnavailableError("--device " + to_string(name) + ": " + listing.problem);
  if (!name.index) {
    const VulkanDeviceInfo* device = first_usable(listing, true);
    if (device == nullptr) device = first_usable(listing, false);
    if (device == nullptr) fail(name, "no device can be used: " + all_of(listing));
    return device->index;
  }
  const VulkanDeviceInfo* const device = numbered(listing, *name.index);
  if (device == nullptr) fail(name, "there is no such device, only " + all_of(listing));
  if (!device->problem.empty()) fail(name, device->name + " cannot be used: " + device->problem);
  return device->index;
}

}  // namespace

DeviceName parse_device_name(const std::string& name) {
  constexpr std::string_view kNumbered = "vulkan:";
  if (name == "auto") return {DeviceName::Kind::kAuto, {}};
  if (name == "cpu") return {DeviceName::Kind::kCpu, {}};
  if (name == "vulkan") return {DeviceName::Kind::kVulkan, {}};
  if (!name.starts_with(kNumbered)) refuse(name);
  return {DeviceName::Kind::kVulkan, index_from(std::string_view(name).substr(kNumbered.size()), name)};
}

DeviceChoice choose_device(const DeviceName& name, const VulkanListing& listing, const IsDistrusted& is_distrusted) {
  if (name.kind == DeviceName::Kind::kCpu) return {};
  if (name.kind == DeviceName::Kind::kVulkan) return {named_device(name, listing), ""};
  DeviceChoice choice;
  for (const VulkanDeviceInfo& device : listing.devices) {
    if (!device.problem.empty() || !device.is_hardware()) continue;
    if (!is_distrusted(device)) return {device.index, choice.remark};
    choice.remark = fmt::format("vulkan:{} ({}) is left out: its last 'gdtslam verify' found differences, or it failed",
                                device.index, device.name);
  }
  return choice;
}

}  // namespace gdtslam
