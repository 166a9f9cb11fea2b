// gdtslam doctor --devices: devices that can compute here, with their limits.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "doctor.hpp"
#include "engine/io/json_file.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

/// Everything that the command shows.
struct Inventory {
  DeviceInfo cpu;
  VulkanListing vulkan;
  std::optional<unsigned> automatic;  ///< choice of --device auto; empty: the CPU
};

Inventory take_inventory() {
  Inventory all;
  all.cpu = make_cpu_backend({.threads = 0, .isa = {}})->device();
  all.vulkan = list_vulkan_devices();
  all.automatic = choose_device({}, all.vulkan);
  return all;
}

std::string size_text(std::size_t bytes) {
  constexpr const char* kUnits[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1024.0 && unit + 1 < std::size(kUnits)) {
    value /= 1024.0;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", value, value == static_cast<double>(static_cast<std::uint64_t>(value)) ? 0 : 1,
                     kUnits[unit]);
}

std::string line(const std::string& name, const std::string& text) { return fmt::format("{:<10} {}\n", name, text); }

std::string cpu_text(const Inventory& all) {
  std::string text = line("cpu", all.cpu.name);
  text += line("", fmt::format("{} thread{}, {}", all.cpu.threads, all.cpu.threads == 1 ? "" : "s", all.cpu.driver));
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    const Isa isa = static_cast<Isa>(k);
    const char* const state = isa == best_isa()    ? "used by default"
                              : isa_available(isa) ? "available"
                                                   : "not on this machine";
    text += line("", fmt::format("--isa {:<9} {}", to_string(isa), state));
  }
  if (!all.automatic) text += line("", "taken by --device auto");
  return text;
}

std::string limits_text(const VulkanDeviceInfo& device) {
  std::string text =
      line("", fmt::format("memory {}, storage buffer {}, uniform buffer {}, shared memory {}",
                           size_text(device.memory_bytes), size_text(device.max_storage_buffer_bytes),
                           size_text(device.max_uniform_buffer_bytes), size_text(device.shared_memory_bytes)));
  const std::string clock =
      device.timestamp_ns > 0.0 ? fmt::format("timestamps of {:g} ns", device.timestamp_ns) : "no timestamps";
  text += line(
      "", fmt::format("{} invocations in a group, subgroup of {}, push constants {}, {}", device.max_group_invocations,
                      device.subgroup_size, size_text(device.max_push_constant_bytes), clock));
  return text;
}

std::string vulkan_text(const Inventory& all, const VulkanDeviceInfo& device) {
  const std::string name = fmt::format("vulkan:{}", device.index);
  std::string text = line(name, device.name);
  text += line("", fmt::format("{}, driver {}, Vulkan {}", device.kind, device.driver, device.api_version));
  text += limits_text(device);
  if (!device.problem.empty()) return text + line("", "cannot be used: " + device.problem);
  if (all.automatic == device.index) text += line("", "taken by --device auto");
  if (!device.is_hardware()) text += line("", "a CPU that plays a GPU: taken only when it is named");
  return text;
}

std::string as_text(const Inventory& all) {
  std::string text = cpu_text(all);
  for (const VulkanDeviceInfo& device : all.vulkan.devices) text += vulkan_text(all, device);
  if (all.vulkan.devices.empty()) text += line("vulkan", "none: " + all.vulkan.problem);
  return text;
}

Json cpu_json(const Inventory& all) {
  Json variants = Json::array();
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    const Isa isa = static_cast<Isa>(k);
    variants.push_back({{"name", to_string(isa)}, {"available", isa_available(isa)}, {"default", isa == best_isa()}});
  }
  return {{"device", "cpu"},
          {"name", all.cpu.name},
          {"driver", all.cpu.driver},
          {"threads", all.cpu.threads},
          {"auto", !all.automatic.has_value()},
          {"isa", variants}};
}

Json limits_json(const VulkanDeviceInfo& device) {
  return {{"memory_bytes", device.memory_bytes},
          {"storage_buffer_bytes", device.max_storage_buffer_bytes},
          {"uniform_buffer_bytes", device.max_uniform_buffer_bytes},
          {"shared_memory_bytes", device.shared_memory_bytes},
          {"group_invocations", device.max_group_invocations},
          {"push_constant_bytes", device.max_push_constant_bytes},
          {"subgroup_size", device.subgroup_size},
          {"timestamp_ns", device.timestamp_ns}};
}

Json vulkan_json(const Inventory& all, const VulkanDeviceInfo& device) {
  return {{"device", fmt::format("vulkan:{}", device.index)},
          {"name", device.name},
          {"kind", device.kind},
          {"driver", device.driver},
          {"uuid", device.uuid},
          {"api_version", device.api_version},
          {"vendor_id", device.vendor_id},
          {"device_id", device.device_id},
          {"problem", device.problem.empty() ? Json() : Json(device.problem)},
          {"auto", all.automatic == device.index},
          {"limits", limits_json(device)}};
}

Json as_json(const Inventory& all) {
  Json devices = Json::array();
  for (const VulkanDeviceInfo& device : all.vulkan.devices) devices.push_back(vulkan_json(all, device));
  return {{"version", GDTSLAM_VERSION},
          {"devices", Json::array({cpu_json(all)})},
          {"vulkan",
           {{"built", GDTSLAM_HAS_VULKAN != 0},
            {"problem", all.vulkan.problem.empty() ? Json() : Json(all.vulkan.problem)},
            {"devices", devices}}}};
}

}  // namespace

int doctor_of_devices(bool json) {
  const Inventory all = take_inventory();
  print_result(json ? json_text(as_json(all)) : as_text(all));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
