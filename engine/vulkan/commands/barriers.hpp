// Tracks the barriers that dispatches and copies need, from their reads and writes of each buffer. Within a queue a
// barrier orders all earlier submissions, so one history serves all command buffers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/vulkan/device/api.hpp"

namespace gdtslam {

enum class Stage : std::uint8_t { kCompute, kTransfer };
inline constexpr std::size_t kStageCount = 2;

/// Numbers of the operations that last wrote and read a buffer, by stage; 0: never.
struct BufferHistory {
  std::array<std::uint64_t, kStageCount> written{};
  std::array<std::uint64_t, kStageCount> read{};
};

/// For each operation call need() for every buffer, begin(), then note() for every buffer.
class BarrierTracker {
 public:
  /// A read must wait for writes, a write for writes and reads.
  void need(const BufferHistory& history, bool is_written);
  /// Records the barrier if one is needed, and starts the next operation.
  void begin(const vk::raii::CommandBuffer& commands);
  void note(BufferHistory& history, Stage stage, bool is_read, bool is_written) const;
  [[nodiscard]] std::uint64_t barrier_count() const { return barrier_count_; }

 private:
  std::uint64_t now_ = 1;                             ///< number of the next operation
  std::array<std::uint64_t, kStageCount> ordered_{};  ///< operations of a stage up to this one precede all later ones
  std::array<bool, kStageCount> waits_for_{};
  std::uint64_t barrier_count_ = 0;
};

}  // namespace gdtslam
