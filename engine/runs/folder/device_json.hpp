// What a report says of the device that did the work. Thread-safe.
#pragma once

#include <nlohmann/json.hpp>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

inline nlohmann::ordered_json device_json(const DeviceInfo& device) {
  return {{"name", device.name}, {"kind", device.kind}, {"driver", device.driver}, {"threads", device.threads}};
}

}  // namespace gdtslam
