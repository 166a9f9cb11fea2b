// The buffers of a device by id, and released buffers that the device still uses.
#pragma once

#include <cstdint>
#include <list>
#include <map>

#include "engine/vulkan/commands/barriers.hpp"
#include "engine/vulkan/device/device.hpp"

namespace gdtslam {

// Device memory: few large blocks, divided into ranges for buffers.

/// A range of a block of device memory.
struct MemoryRange {
  vk::DeviceMemory memory;
  std::uint64_t block = 0;  ///< its block, for give_back()
  std::size_t offset = 0;
  std::size_t bytes = 0;
};

/// First-fit allocation from blocks; a buffer that is large relative to a block gets its own.
class BlockMemory {
 public:
  explicit BlockMemory(const Device& device);

  /// Throws DeviceError with the sizes if the device has no more.
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

/// A memory type allowed by `bits`, with the wanted properties if possible, else with the needed ones.
std::uint32_t memory_type(const Device& device, std::uint32_t bits, vk::MemoryPropertyFlags wanted,
                          vk::MemoryPropertyFlags needed);

struct DeviceBuffer {
  vk::raii::Buffer handle{nullptr};
  MemoryRange range;
  std::size_t bytes = 0;         ///< requested size
  std::size_t padded_bytes = 0;  ///< allocated size, at least 16 and a multiple of 16
  bool is_fresh = true;          ///< not yet zeroed
  BufferHistory history;
  std::uint64_t last_batch = 0;  ///< the last batch that uses it
};

/// Allocated bytes of a buffer of `bytes`.
std::size_t padded_size(std::size_t bytes);

class Buffers {
 public:
  explicit Buffers(const Device& device) : device_(device), memory_(device) {}
  Buffers(const Buffers&) = delete;
  Buffers& operator=(const Buffers&) = delete;
  ~Buffers();

  /// Throws DeviceError with both sizes if it exceeds the device's limit. Makes no call.
  void check_size(std::size_t bytes) const;
  std::uint64_t create(std::size_t bytes);
  DeviceBuffer& at(std::uint64_t id) { return live_.at(id); }
  /// Keeps a buffer until its last batch is done.
  void release(std::uint64_t id) noexcept;
  /// Destroys released buffers whose batch is done.
  void collect(std::uint64_t done_batch) noexcept;
  [[nodiscard]] bool has_released() const { return !released_.empty(); }
  /// Whether an allocation of this size would almost exhaust the device's memory.
  [[nodiscard]] bool would_be_tight(std::size_t bytes) const;

 private:
  const Device& device_;
  BlockMemory memory_;
  std::map<std::uint64_t, DeviceBuffer> live_;
  std::map<std::uint64_t, DeviceBuffer> released_;
  std::uint64_t next_id_ = 1;
};

}  // namespace gdtslam
