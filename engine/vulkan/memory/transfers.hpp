// The only transfer between host and device, whatever memory they share: staging memory visible to both, and copies by
// the device. Each batch has a segment for uploads and one for downloads; larger transfers are split.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "buffers.hpp"
#include "engine/vulkan/commands/batches.hpp"

namespace gdtslam {

/// Mapped host-visible memory in equal segments.
class StagingRing {
 public:
  StagingRing(const Device& device, std::size_t segment_bytes, vk::BufferUsageFlags usage,
              vk::MemoryPropertyFlags wanted);
  [[nodiscard]] vk::Buffer buffer() const { return *buffer_; }
  [[nodiscard]] std::byte* at(std::size_t offset) const { return memory_ + offset; }
  /// Takes up to `bytes` of a segment; returns the number, 0 if it is full.
  std::size_t take(std::size_t segment, std::size_t bytes, std::size_t& offset);
  void reset(std::size_t segment) { used_[segment] = 0; }

 private:
  std::size_t segment_bytes_;
  vk::raii::Buffer buffer_;
  vk::raii::DeviceMemory device_memory_;
  std::byte* memory_ = nullptr;
  std::array<std::size_t, Batches::kSlots> used_{};
};

class Transfers {
 public:
  Transfers(const Device& device, Batches& batches, BarrierTracker& barriers);

  void upload(DeviceBuffer& target, std::span<const std::byte> data, std::size_t offset);
  void fill(DeviceBuffer& target, std::uint32_t word);
  /// Both buffers have the same size.
  void copy(DeviceBuffer& source, DeviceBuffer& target);
  /// Zeroes a buffer that has not been written yet.
  void make_ready(DeviceBuffer& buffer);
  std::uint64_t start_download(DeviceBuffer& source, std::size_t bytes, std::size_t offset);
  /// False if there is no such download of that size.
  [[nodiscard]] bool is_under_way(std::uint64_t id, std::size_t bytes) const;
  void finish_download(std::uint64_t id, std::span<std::byte> data);
  /// Drops a download; a copy still queued is ignored.
  void forget(std::uint64_t id) noexcept { downloads_.erase(id); }
  /// Copies and fills so far: the memory members of QueueWork.
  [[nodiscard]] const QueueWork& counts() const { return counts_; }
  [[nodiscard]] std::size_t under_way() const { return downloads_.size(); }

 private:
  /// A part of a download, with its position in the ring until the slot is reused.
  struct Piece {
    std::uint64_t batch = 0;
    std::size_t slot = 0;
    std::size_t ring_offset = 0;
    std::size_t target_offset = 0;
    std::size_t bytes = 0;
    bool is_kept = false;  ///< copied to Download::kept
  };
  struct Download {
    std::size_t bytes = 0;
    std::vector<Piece> pieces;
    std::unique_ptr<std::byte[]> kept;  ///< pieces whose place in the ring was reused
  };
  void begin_operation(DeviceBuffer& buffer, bool is_written);
  void note_operation(DeviceBuffer& buffer, bool is_written);
  /// Saves a slot's segment for downloads that were not fetched yet.
  void reuse(std::size_t slot);

  Batches& batches_;
  BarrierTracker& barriers_;
  StagingRing up_;
  StagingRing down_;
  std::map<std::uint64_t, Download> downloads_;
  std::uint64_t next_id_ = 1;
  QueueWork counts_;
};

}  // namespace gdtslam
