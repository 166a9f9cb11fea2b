// What `gdtslam verify` found last on each device, kept in the cache folder so that `gdtslam devices` can tell and
// `--device auto` can leave out a device that computes wrongly or fails. A result counts for the device (one of several
// equal ones has its UUID), driver, version of gdtslam and shaders that it was made with, and for no other. A file that
// cannot be read is as good as none.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "gdtslam/vulkan/vulkan.hpp"

namespace gdtslam {

struct VerifyRecord {
  std::string date;  ///< UTC, ISO 8601
  std::uint64_t cases = 0;
  std::uint64_t logs = 0;
  std::uint64_t differences = 0;
  std::string failure{};  ///< what the device's driver said when it failed and ended the verification; else empty
  [[nodiscard]] bool passed() const { return differences == 0 && failure.empty(); }
};

/// SHA-256 over the names and words of the shaders.
std::string digest_of(std::span<const ShaderModule> shaders);

class VerifyRecords {
 public:
  /// `folder` as of cache_folder(); empty: nothing is found and nothing kept. `shaders` is a digest.
  VerifyRecords(std::string folder, std::string shaders);

  [[nodiscard]] std::optional<VerifyRecord> find(const VulkanDeviceInfo& device) const;
  /// Replaces what is kept for this device. Throws FileError.
  void keep(const VulkanDeviceInfo& device, const VerifyRecord& record) const;

 private:
  [[nodiscard]] std::string file() const;

  std::string folder_;
  std::string shaders_;
};

/// The records of this build in the user's cache folder.
VerifyRecords user_records();

}  // namespace gdtslam
