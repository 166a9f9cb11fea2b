// Choice of the device: --device, --threads, --isa and --no-fallback; which device a name stands for, and what a mapper
// does when it fails.
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
  bool are_threads_given = false;  ///< else a mapper may look for loops by a thread more
  std::string isa{};               ///< empty: the strongest there is
  bool no_fallback = false;
};

/// --device, --threads and --isa; with_fallback also --no-fallback.
void add_device_options(CLI::App& command, DeviceOptions& options, bool with_fallback = true);

/// The instruction set of that name: baseline, avx2 or avx512. Throws UsageError.
Isa isa_from_name(const std::string& name);

/// The CPU's threads and instruction set, empty where none is named. Throws UsageError.
CpuOptions cpu_options(const DeviceOptions& options);

/// The CPU with its threads and instruction set.
std::unique_ptr<Backend> make_cpu(const DeviceOptions& options);

/// The Vulkan device that was asked for, or nothing where the CPU is meant (choose_device() has the rules). A
/// pipeline cache is kept in the user's cache folder; the rest is as in `wanted`. Throws UsageError, UnavailableError
/// and DeviceError.
std::unique_ptr<VulkanBackend> make_vulkan(const DeviceOptions& options, VulkanOptions wanted = {});

/// The backend that was asked for. A device whose driver fails while it is opened is replaced by the CPU with one
/// warning, unless no_fallback is set. Throws UnavailableError for a device that this machine does not have.
std::unique_ptr<Backend> make_backend(const DeviceOptions& options);

/// The backend of a command for which there may be nothing that a device would do. One that is named is opened at once;
/// a GPU is looked for, which takes a driver's memory and time, only where there is work for it.
class BackendWhenNeeded {
 public:
  /// Throws as make_backend().
  explicit BackendWhenNeeded(const DeviceOptions& options);
  /// The backend for the first call; later ones give the same.
  Backend& of(bool has_work);

 private:
  DeviceOptions options_;
  bool is_chosen_;
  std::unique_ptr<Backend> backend_;
};

// Values in, values out: nothing is opened below.

struct DeviceName {
  enum class Kind : std::uint8_t { kAuto, kCpu, kVulkan };
  Kind kind = Kind::kAuto;
  std::optional<unsigned> index;  ///< N of vulkan:N
};

/// Throws UsageError.
DeviceName parse_device_name(const std::string& name);

/// The index in the listing, empty for the CPU. auto: the first hardware GPU that can be used, else the CPU. vulkan:
/// the first hardware GPU that can be used, else the first device of any kind, because Vulkan was named. vulkan:N: that
/// one. Throws UnavailableError where a device was named that is not there or cannot be used.
std::optional<unsigned> choose_device(const DeviceName& name, const VulkanListing& listing);

/// The reaction of a mapper to a device that fails: it goes on with the CPU that the options describe and prints one
/// warning; or, without fallback, fails.
MapperOptions on_failure_of(const DeviceOptions& options);

}  // namespace gdtslam
