#include "barriers.hpp"

namespace gdtslam {
namespace {

using AccessBit = vk::AccessFlagBits;
using StageBit = vk::PipelineStageFlagBits;

constexpr std::size_t kCompute = static_cast<std::size_t>(Stage::kCompute);
constexpr std::size_t kTransfer = static_cast<std::size_t>(Stage::kTransfer);

}  // namespace

void BarrierTracker::need(const BufferHistory& history, bool is_written) {
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    const bool after_write = history.written[stage] > ordered_[stage];
    const bool after_read = is_written && history.read[stage] > ordered_[stage];
    waits_for_[stage] = waits_for_[stage] || after_write || after_read;
  }
}

void BarrierTracker::begin(const vk::raii::CommandBuffer& commands) {
  vk::PipelineStageFlags before;
  vk::MemoryBarrier memory;
  if (waits_for_[kCompute]) {
    before |= StageBit::eComputeShader;
    memory.srcAccessMask |= AccessBit::eShaderWrite;
  }
  if (waits_for_[kTransfer]) {
    before |= StageBit::eTransfer;
    memory.srcAccessMask |= AccessBit::eTransferWrite;
  }
  if (before) {
    // All later operations wait, so that one barrier serves every buffer.
    memory.dstAccessMask =
        AccessBit::eShaderRead | AccessBit::eShaderWrite | AccessBit::eTransferRead | AccessBit::eTransferWrite;
    commands.pipelineBarrier(before, StageBit::eComputeShader | StageBit::eTransfer, {}, memory, {}, {});
    ++barrier_count_;
    for (std::size_t stage = 0; stage < kStageCount; ++stage) {
      ordered_[stage] = waits_for_[stage] ? now_ - 1 : ordered_[stage];
    }
    waits_for_ = {};
  }
  ++now_;
}

void BarrierTracker::note(BufferHistory& history, Stage stage, bool is_read, bool is_written) const {
  const auto at = static_cast<std::size_t>(stage);
  if (is_read) {
    history.read[at] = now_ - 1;
  }
  if (is_written) {
    history.written[at] = now_ - 1;
  }
}

}  // namespace gdtslam
