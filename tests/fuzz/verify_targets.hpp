// What `verify` kept of an earlier call.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "target.hpp"
#include "tools/gdtslam/shell/device/verify_record.hpp"

namespace gdtslam::fuzz {

/// What `verify` found on devices: a file that is damaged is as good as none, and a result that is kept is found.
inline void read_verify_records(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  folder.put("verify.json", text_of(data));
  const VerifyRecords records(folder.path(), "shaders");
  VulkanDeviceInfo device;
  device.name = "device";
  device.driver = "driver";
  static_cast<void>(records.find(device));
  records.keep(device, {"2026-01-02", 3, 2, 1, ""});
  const std::optional<VerifyRecord> kept = records.find(device);
  require(kept && kept->cases == 3 && kept->logs == 2 && kept->differences == 1 && !kept->passed());
}

inline constexpr std::array kVerifyTargets{FuzzTarget{"verify", read_verify_records, 3}};

}  // namespace gdtslam::fuzz
