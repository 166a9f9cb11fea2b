// Where the work runs: --device, --threads, --isa and --no-fallback.
#pragma once

#include <memory>
#include <string>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "tools/gdtslam/shell/cli.hpp"

namespace gdtslam {

struct DeviceOptions {
  std::string device = "auto";
  unsigned threads = 1;
  std::string isa{};  ///< empty: the strongest there is
  bool no_fallback = false;
};

/// --device, --threads and --isa; with_fallback also --no-fallback.
void add_device_options(CLI::App& command, DeviceOptions& options, bool with_fallback = true);

/// The instruction set of that name: baseline, avx2 or avx512. Throws UsageError.
Isa isa_from_name(const std::string& name);

/// The CPU with its threads and instruction set.
std::unique_ptr<Backend> make_cpu(const DeviceOptions& options);

/// The Vulkan device that was asked for, or nothing where the CPU is meant (device_choice.hpp has the rules). A
/// pipeline cache is kept in the user's cache folder; the rest is as in `wanted`. Throws UsageError, UnavailableError
/// and DeviceError.
std::unique_ptr<VulkanBackend> make_vulkan(const DeviceOptions& options, VulkanOptions wanted = {});

/// The backend that was asked for. A device whose driver fails while it is opened is replaced by the CPU with one
/// warning, unless no_fallback is set. Throws UnavailableError for a device that this machine does not have.
std::unique_ptr<Backend> make_backend(const DeviceOptions& options);

}  // namespace gdtslam
