// The buffers of a device by their ids, and those that are released and still in use by the device.
#pragma once

#include <cstdint>
#include <map>

#include "engine/vulkan/commands/barriers.hpp"
#include "memory.hpp"

namespace gdtslam {

struct DeviceBuffer {
  vk::raii::Buffer handle{nullptr};
  MemoryRange range;
  std::size_t bytes = 0;         ///< requested size
  std::size_t padded_bytes = 0;  ///< allocated size, at least 16 and a multiple of 16
  bool is_fresh = true;          ///< not yet zeroed
  BufferHistory history;
  std::uint64_t last_batch = 0;  ///< the last batch that uses it
};

/// Bytes that a buffer of `bytes` really has.
std::size_t padded_size(std::size_t bytes);

class Buffers {
 public:
  explicit Buffers(const Device& device) : device_(device), memory_(device) {}
  Buffers(const Buffers&) = delete;
  Buffers& operator=(const Buffers&) = delete;
  ~Buffers();

  /// Throws DeviceError with both sizes when it exceeds what the device allows. Calls nothing.
  void check_size(std::size_t bytes) const;
  std::uint64_t create(std::size_t bytes);
  DeviceBuffer& at(std::uint64_t id) { return live_.at(id); }
  /// Puts a buffer aside until its last batch is done.
  void release(std::uint64_t id) noexcept;
  /// Destroys what was put aside and whose batch is done.
  void collect(std::uint64_t done_batch) noexcept;
  [[nodiscard]] bool has_released() const { return !released_.empty(); }
  /// Whether that much more would bring the device's memory near its end.
  [[nodiscard]] bool would_be_tight(std::size_t bytes) const;

 private:
  const Device& device_;
  BlockMemory memory_;
  std::map<std::uint64_t, DeviceBuffer> live_;
  std::map<std::uint64_t, DeviceBuffer> released_;
  std::uint64_t next_id_ = 1;
};

}  // namespace gdtslam
