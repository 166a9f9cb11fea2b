// A device that a long computation on the host may give batches of work, until it fails.
#pragma once

#include <functional>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// Text after a device's error where the host goes on.
inline constexpr const char* kGoingOnWithCpu = "; going on with the CPU, which gives the same results";

/// The device for batches of a long computation, if there is one.
struct BatchDevice {
  std::function<Backend*()> get = [] { return static_cast<Backend*>(nullptr); };  ///< null: the host does the work
  /// Told of a failure, after which get() gives null; throws if the host may not go on.
  std::function<void(const DeviceError&)> lost = [](const DeviceError& error) { throw DeviceError(error); };
};

}  // namespace gdtslam
