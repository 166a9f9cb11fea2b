// Where the work runs: --device, --threads, --isa and --no-fallback.
#pragma once

#include <memory>
#include <string>

#include <CLI/App.hpp>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

struct DeviceOptions {
  std::string device = "auto";
  unsigned threads = 1;
  std::string isa{};  ///< empty: the strongest there is
  bool no_fallback = false;
};

void add_device_options(CLI::App& command, DeviceOptions& options);

/// The backend that was asked for. Throws UnavailableError for a device that this build or this machine does not have.
std::unique_ptr<Backend> make_backend(const DeviceOptions& options);

/// The instruction set of that name: baseline, avx2 or avx512. Throws UsageError.
Isa isa_from_name(const std::string& name);

}  // namespace gdtslam
