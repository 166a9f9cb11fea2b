// Choice of the device: --device, --threads, --isa and --no-fallback; resolving a device's name; a mapper's reaction if
// it fails.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "tools/gdtslam/shell/cli.hpp"

namespace gdtslam {

struct DeviceOptions {
  std::string device = "auto";
  unsigned threads = 1;
  bool are_threads_given = false;  ///< else a mapper may use one more thread for loops
  std::string isa{};               ///< empty: the strongest one available
  bool no_fallback = false;
};

/// Adds --device and --threads; with_fallback also --no-fallback, with_isa also --isa.
void add_device_options(CLI::App& command, DeviceOptions& options, bool with_fallback = true, bool with_isa = true);

/// Parses baseline, avx2 or avx512. Throws UsageError.
Isa isa_from_name(const std::string& name);

/// The CPU's threads and instruction set; empty if not given. Throws UsageError.
CpuOptions cpu_options(const DeviceOptions& options);

/// The CPU with its threads and instruction set.
std::unique_ptr<Backend> make_cpu(const DeviceOptions& options);

/// The requested Vulkan device; null for the CPU (rules: choose_device()). The user's cache folder keeps a pipeline
/// cache; the rest is as in `wanted`. Throws UsageError, UnavailableError and DeviceError.
std::unique_ptr<VulkanBackend> make_vulkan(const DeviceOptions& options, VulkanOptions wanted = {});

/// The requested backend. If a device's driver fails on opening, the CPU replaces it with one warning, unless
/// no_fallback is set. Throws UnavailableError for a device that this machine does not have.
std::unique_ptr<Backend> make_backend(const DeviceOptions& options);

/// Backend of a command that may have no work for a device. A named device is opened at once. An automatic choice looks
/// for a GPU, which costs time and memory, only if there is work.
class BackendWhenNeeded {
 public:
  /// Throws like make_backend().
  explicit BackendWhenNeeded(const DeviceOptions& options);
  /// Opens the backend on the first call; later calls return the same one.
  Backend& of(bool has_work);

 private:
  DeviceOptions options_;
  bool is_chosen_;
  std::unique_ptr<Backend> backend_;
};

// Pure functions: nothing is opened below.

struct DeviceName {
  enum class Kind : std::uint8_t { kAuto, kCpu, kVulkan };
  Kind kind = Kind::kAuto;
  std::optional<unsigned> index;  ///< N of vulkan:N
};

/// Throws UsageError.
DeviceName parse_device_name(const std::string& name);

/// Index in the listing, empty for the CPU. auto: the first usable hardware GPU, else the CPU. vulkan: the first usable
/// hardware GPU, else the first device of any kind, because Vulkan was named. vulkan:N: device N. Throws
/// UnavailableError for a named device that is missing or unusable.
std::optional<unsigned> choose_device(const DeviceName& name, const VulkanListing& listing);

/// A mapper's reaction to a failing device: continue on the CPU of these options with one warning, or fail without
/// fallback.
MapperOptions on_failure_of(const DeviceOptions& options);

}  // namespace gdtslam
