// Device memory: few large blocks, cut into the ranges that buffers are bound to.
#pragma once

#include <cstdint>
#include <list>
#include <map>

#include "engine/vulkan/device/device.hpp"

namespace gdtslam {

/// A range of a block of device memory.
struct MemoryRange {
  vk::DeviceMemory memory;
  std::uint64_t block = 0;  ///< which block, for give_back()
  std::size_t offset = 0;
  std::size_t bytes = 0;
};

/// First-fit allocation from blocks; a buffer that is large against a block gets its own.
class BlockMemory {
 public:
  explicit BlockMemory(const Device& device);

  /// Throws DeviceError with the sizes when the device has no more.
  MemoryRange take(const vk::MemoryRequirements& requirements);
  void give_back(const MemoryRange& range) noexcept;
  /// Size of all blocks together.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Block {
    std::uint64_t id = 0;
    std::uint32_t type = 0;
    std::size_t bytes = 0;
    vk::raii::DeviceMemory memory;
    std::map<std::size_t, std::size_t> free;  ///< offset to size, neighbours joined
  };
  Block& add_block(std::uint32_t type, std::size_t bytes);
  bool take_from(Block& block, const vk::MemoryRequirements& requirements, MemoryRange& range);

  const Device& device_;
  std::size_t block_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t next_id_ = 1;
  std::list<Block> blocks_;
};

/// A type of memory that is allowed by `bits` and has the wanted properties, then one with the needed ones.
std::uint32_t memory_type(const Device& device, std::uint32_t bits, vk::MemoryPropertyFlags wanted,
                          vk::MemoryPropertyFlags needed);

}  // namespace gdtslam
