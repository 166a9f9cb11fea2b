// Which barriers a sequence of dispatches and copies needs, from what each did to which buffer. Within a queue a
// barrier orders all that was submitted before it, so one history serves all command buffers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/vulkan/device/api.hpp"

namespace gdtslam {

enum class Stage : std::uint8_t { kCompute, kTransfer };
inline constexpr std::size_t kStageCount = 2;

/// When a buffer was last written and read by each stage, as numbers of operations; 0: never.
struct BufferHistory {
  std::array<std::uint64_t, kStageCount> written{};
  std::array<std::uint64_t, kStageCount> read{};
};

/// For each operation: need() of every buffer that it uses, begin(), note() of every buffer.
class BarrierTracker {
 public:
  /// A read has to wait for writes, a write for writes and reads.
  void need(const BufferHistory& history, bool is_written);
  /// Records the barrier where one is needed, and starts the next operation.
  void begin(const vk::raii::CommandBuffer& commands);
  void note(BufferHistory& history, Stage stage, bool is_read, bool is_written) const;
  [[nodiscard]] std::uint64_t barrier_count() const { return barrier_count_; }

 private:
  std::uint64_t now_ = 1;                             ///< number of the next operation
  std::array<std::uint64_t, kStageCount> ordered_{};  ///< operations of a stage up to this one come before all to come
  std::array<bool, kStageCount> waits_for_{};
  std::uint64_t barrier_count_ = 0;
};

}  // namespace gdtslam
