// Vulkan compute as a backend. The loader is opened at run time, so a program that links this also runs without Vulkan,
// and using it needs no Vulkan header. Source of the rules: docs/numerics.md, docs/architecture.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// A physical device as described by its driver.
struct VulkanDeviceInfo {
  unsigned index = 0;  ///< N of vulkan:N
  std::string name;
  std::string kind;         ///< "discrete", "integrated", "virtual", "lavapipe" (a CPU as a device), "other"
  std::string driver;       ///< driver, its version and its additional text
  std::string api_version;  ///< for example "1.3.230"
  std::string problem;      ///< reason why it cannot be used; empty if it can
  std::string uuid;         ///< identity among equal devices, 32 hexadecimal digits; empty if unusable
  std::uint32_t vendor_id = 0;
  std::uint32_t device_id = 0;
  std::size_t memory_bytes = 0;  ///< size of its largest device-local heap
  std::size_t max_storage_buffer_bytes = 0;
  std::size_t max_uniform_buffer_bytes = 0;
  std::size_t shared_memory_bytes = 0;
  std::uint32_t max_group_invocations = 0;
  std::uint32_t max_push_constant_bytes = 0;
  std::uint32_t subgroup_size = 0;
  double timestamp_ns = 0.0;  ///< nanoseconds per tick; 0: no usable timestamps
  /// Whether it is a GPU rather than a CPU that emulates one.
  [[nodiscard]] bool is_hardware() const { return kind == "discrete" || kind == "integrated" || kind == "virtual"; }
};

/// The devices that Vulkan finds.
struct VulkanListing {
  std::vector<VulkanDeviceInfo> devices;
  std::string problem;  ///< reason why there is none: no loader, no driver, or the failed call
};

/// Lists the Vulkan devices of this machine. Never throws for missing parts.
VulkanListing list_vulkan_devices();

/// Choice of the device, and its use.
struct VulkanOptions {
  std::optional<unsigned> index = std::nullopt;  ///< index in the listing; empty: the first hardware GPU
  std::string cache_folder = {};                 ///< folder of the pipeline cache; empty: none is read or written
  /// Enables validation and synchronisation validation: their warnings and errors throw DeviceError at the next launch,
  /// flush or finished download. Also by GDTSLAM_VULKAN_VALIDATION=1. Needs the Khronos layer.
  bool validation = false;
  /// Receives validation messages that come too late to be thrown: about work recorded after the last flush and about
  /// the end of the backend. It must not throw. Empty: such a message ends the process (std::terminate).
  std::function<void(std::string_view message)> on_message = {};
  /// A longer wait counts as a lost device. Empty: GDTSLAM_VULKAN_WAIT_S of the environment, else 30 s.
  std::optional<double> wait_limit_s = std::nullopt;
  /// Time for which the host polls a GPU for the end of a submission before it sleeps, because waking takes the system
  /// tens of microseconds. Empty: GDTSLAM_VULKAN_SPIN_S of the environment, else 5e-5 s on hardware and 0 on lavapipe,
  /// whose threads need the processor themselves.
  std::optional<double> spin_s = std::nullopt;
  /// Timestamps around each submission. Empty: on hardware only, because they cost lavapipe 45 us per submission.
  std::optional<bool> time_submissions = std::nullopt;
  /// Step of the backend, counted from 1 (its creation), at which a lost device is simulated; 0: none. A step is one
  /// call with work for the device.
  std::uint64_t lost_at = 0;
  /// Called with each shader before it is built, to change it: tests show with it that a wrong shader is found.
  std::function<void(std::string_view shader, std::vector<std::uint32_t>& spirv)> edit_shader = {};
  /// Called with the properties of the chosen device before it is used. Tests lower its limits here to simulate a
  /// smaller device. Variants are chosen by the resulting max_group_invocations.
  std::function<void(VulkanDeviceInfo&)> edit_device = {};
};

/// A backend with the counters of a Vulkan device.
class VulkanBackend : public Backend {
 public:
  [[nodiscard]] virtual const VulkanDeviceInfo& vulkan_device() const = 0;
  /// Time by the device's own clock between the start and the end of the last finished submission, nanoseconds; 0 if it
  /// is not measured.
  [[nodiscard]] virtual double last_submission_ns() const = 0;
  /// Copies a buffer to another of the same size, queued with the other work. Benchmarks use it as the bandwidth of the
  /// device's memory.
  virtual void copy(const Buffer& source, const Buffer& target) = 0;
  /// Whether a valid pipeline cache of an earlier run was loaded.
  [[nodiscard]] virtual bool cache_was_loaded() const = 0;
  /// Writes the pipeline cache if it has grown; the destructor does so too. Returns false on failure, which only costs
  /// time at the next start.
  virtual bool save_cache() noexcept = 0;
};

/// Throws UnavailableError if there is no such device, DeviceError if a call of its driver fails.
std::unique_ptr<VulkanBackend> make_vulkan_backend(const VulkanOptions& options);

/// A shader as the backend uses it, for tests of its internals.
struct ShaderModule {
  std::string_view kernel;  ///< name of the kernel, and stem of the file in shaders/
  std::span<const std::uint32_t> spirv;
  std::array<std::uint32_t, 3> local_size{};
  std::uint32_t push_constant_bytes = 0;
  bool is_always_suitable = false;  ///< suits every launch and every device
};
/// In the order of the registry; a kernel's variants in the order of their trial.
std::span<const ShaderModule> shader_modules();

}  // namespace gdtslam
