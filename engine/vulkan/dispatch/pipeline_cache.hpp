// What the driver compiled, kept from run to run: a file per device and driver, which is checked before it is used and
// ignored when it is damaged or foreign.
#pragma once

#include <cstdint>
#include <string>

#include "engine/vulkan/device/device.hpp"

namespace gdtslam {

/// Every call within a DriverCalls::Scope.
class PipelineCache {
 public:
  /// An empty folder name: nothing is read or written.
  PipelineCache(const Device& device, const std::string& folder);

  [[nodiscard]] const vk::raii::PipelineCache& handle() const { return handle_; }
  [[nodiscard]] bool was_loaded() const { return was_loaded_; }
  /// Writes the file anew, under another name first. False when that failed.
  [[nodiscard]] bool save() const;

 private:
  std::string path_;
  bool was_loaded_ = false;
  vk::raii::PipelineCache handle_;
};

}  // namespace gdtslam
