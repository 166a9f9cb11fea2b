// Vulkan compute as a backend. The loader is opened at run time, so a program that links this runs on machines without
// Vulkan as well; no Vulkan header is needed to use it. Source of the rules: docs/numerics.md, docs/architecture.md.
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

/// A physical device as the driver describes it.
struct VulkanDeviceInfo {
  unsigned index = 0;  ///< N of vulkan:N
  std::string name;
  std::string kind;         ///< "discrete", "integrated", "virtual", "lavapipe" (a CPU as a device), "other"
  std::string driver;       ///< driver, its version, what it adds
  std::string api_version;  ///< for example "1.3.230"
  std::string problem;      ///< why it cannot be used; empty when it can
  std::string uuid;         ///< which of several equal ones, 32 hexadecimal digits; empty where it cannot be used
  std::uint32_t vendor_id = 0;
  std::uint32_t device_id = 0;
  std::size_t memory_bytes = 0;  ///< size of its largest device-local heap
  std::size_t max_storage_buffer_bytes = 0;
  std::size_t max_uniform_buffer_bytes = 0;
  std::size_t shared_memory_bytes = 0;
  std::uint32_t max_group_invocations = 0;
  std::uint32_t max_push_constant_bytes = 0;
  std::uint32_t subgroup_size = 0;
  double timestamp_ns = 0.0;  ///< nanoseconds of one tick; 0: no timestamps, or none that a backend takes
  /// Whether it is a GPU rather than a CPU that plays one.
  [[nodiscard]] bool is_hardware() const { return kind == "discrete" || kind == "integrated" || kind == "virtual"; }
};

/// The devices that Vulkan finds.
struct VulkanListing {
  std::vector<VulkanDeviceInfo> devices;
  std::string problem;  ///< why there is none: no loader, no driver, or the call that failed
};

/// Lists the Vulkan devices of this machine. Never throws for missing parts.
VulkanListing list_vulkan_devices();

/// Which device, and how it is used.
struct VulkanOptions {
  std::optional<unsigned> index = std::nullopt;  ///< index in the listing; the first hardware GPU when empty
  std::string cache_folder = {};                 ///< folder of the pipeline cache; empty: none is read or written
  /// With validation and synchronisation validation: a warning or an error of theirs throws DeviceError at the next
  /// launch, flush or finished download. Also by GDTSLAM_VULKAN_VALIDATION=1. Needs the Khronos layer.
  bool validation = false;
  /// Receives validation messages that come too late to be thrown, about work recorded after the last flush and the end
  /// of the backend. It must not throw. Empty: such a message ends the process (std::terminate).
  std::function<void(std::string_view message)> on_message = {};
  /// A wait that takes longer is a lost device. Empty: GDTSLAM_VULKAN_WAIT_S of the environment, else 30 s.
  std::optional<double> wait_limit_s = std::nullopt;
  /// Time for which the host polls a GPU for the end of a submission before it sleeps, because the system takes tens of
  /// microseconds to wake it. Empty: GDTSLAM_VULKAN_SPIN_S of the environment, else 5e-5 s on hardware and 0 on
  /// lavapipe, whose threads need the processor themselves.
  std::optional<double> spin_s = std::nullopt;
  /// Timestamps around each submission. Empty: on hardware only, since lavapipe takes 45 us a submission for them.
  std::optional<bool> time_submissions = std::nullopt;
  /// Step of the backend, from 1 (its making), at which the device is lost, as a rehearsal; 0: none. A step is a verb's
  /// work for the device.
  std::uint64_t lost_at = 0;
  /// Called with each shader before it is built, to change it: a test's way to show that a wrong shader is found.
  std::function<void(std::string_view shader, std::vector<std::uint32_t>& spirv)> edit_shader = {};
  /// Called with the properties of the chosen device before it is used. Tests lower its limits here to simulate a
  /// device that offers less. Variants are chosen by max_group_invocations as it then is.
  std::function<void(VulkanDeviceInfo&)> edit_device = {};
};

/// Work that a device was given so far, by the state of its queue. The difference of two is the work between them.
struct QueueWork {
  std::map<std::string_view, std::uint64_t> dispatches;  ///< by kernel, without launches of no invocations
  std::uint64_t submissions = 0;
  std::uint64_t waits = 0;     ///< waits of the host for a submission that was not known to be done
  std::uint64_t barriers = 0;  ///< that the kernels' bindings and the transfers ask for
  std::uint64_t fills = 0;     ///< also of new buffers with zeros
  std::uint64_t uploads = 0;
  std::uint64_t upload_bytes = 0;
  std::uint64_t downloads = 0;  ///< copies that the device makes for the host
  std::uint64_t download_bytes = 0;

  [[nodiscard]] std::uint64_t dispatch_sum() const;
};
/// Member by member; `before` must be the earlier one.
QueueWork operator-(const QueueWork& now, const QueueWork& before);
QueueWork& operator+=(QueueWork& sum, const QueueWork& more);

/// A backend with counters that only a Vulkan device can have.
class VulkanBackend : public Backend {
 public:
  [[nodiscard]] virtual const VulkanDeviceInfo& vulkan_device() const = 0;
  /// Nanoseconds of the device's own clock between the start and the end of the last finished submission; 0 if none are
  /// taken.
  [[nodiscard]] virtual double last_submission_ns() const = 0;
  [[nodiscard]] virtual QueueWork work() const = 0;
  /// Copies a buffer to another of the same size, queued with the other work. Benchmarks compare with it as the
  /// bandwidth of the device's memory.
  virtual void copy(const Buffer& source, const Buffer& target) = 0;
  /// Whether a pipeline cache of an earlier run was found and taken.
  [[nodiscard]] virtual bool cache_was_loaded() const = 0;
  /// Writes the pipeline cache if something was added to it, as the destructor does. Returns false on failure, which
  /// only costs time at the next start.
  virtual bool save_cache() noexcept = 0;
};

/// Throws UnavailableError when there is no such device, DeviceError when a call of its driver fails.
std::unique_ptr<VulkanBackend> make_vulkan_backend(const VulkanOptions& options);

/// A shader of the build as the backend uses it, for the tests that look inside.
struct ShaderModule {
  std::string_view kernel;  ///< whose name is the stem of the file in shaders/
  std::span<const std::uint32_t> spirv;
  std::array<std::uint32_t, 3> local_size{};
  std::uint32_t push_constant_bytes = 0;
  bool is_always_suitable = false;  ///< serves every launch and every device
};
/// In the order of the registry, and for each kernel in the order in which its variants are tried.
std::span<const ShaderModule> shader_modules();

}  // namespace gdtslam
