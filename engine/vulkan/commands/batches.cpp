#include "batches.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>

#include "engine/vulkan/device/environment.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kStampsPerBatch = 2;

std::string timeout_text(double limit_s) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), limit_s);
  return vk::to_string(vk::Result::eTimeout) + ": it takes longer than " +
         std::string(digits.data(), error == std::errc{} ? end : digits.data()) + " s; " + kWaitLimitVariable +
         "=SECONDS in the environment allows more";
}

}  // namespace

std::uint64_t to_nanoseconds(double seconds) {
  constexpr double kMost = 1.0e9;  // some thirty years; larger values would overflow
  return static_cast<std::uint64_t>(std::clamp(seconds, 0.0, kMost) * 1.0e9);
}

vk::SemaphoreWaitInfo wait_info(const vk::Semaphore& timeline, const std::uint64_t& value) {
  vk::SemaphoreWaitInfo info;
  info.setSemaphores(timeline);
  info.setValues(value);
  return info;
}

Batches::Slot Batches::make_slot(const Device& device) {
  Slot slot;
  slot.pool = vk::raii::CommandPool(
      device.handle(), vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eTransient, device.queue_family()));
  slot.commands =
      std::move(vk::raii::CommandBuffers(device.handle(),
                                         vk::CommandBufferAllocateInfo(*slot.pool, vk::CommandBufferLevel::ePrimary, 1))
                    .front());
  if (device.info().timestamp_ns > 0.0) {
    slot.stamps =
        vk::raii::QueryPool(device.handle(), vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, kStampsPerBatch));
  }
  return slot;
}

Batches::Batches(const Device& device, double wait_limit_s, double spin_s)
    : device_(device), wait_limit_s_(wait_limit_s), spin_s_(std::max(0.0, std::min(spin_s, wait_limit_s))) {
  for (Slot& slot : slots_) {
    slot = make_slot(device);
  }
}

const vk::raii::CommandBuffer& Batches::commands() {
  if (!is_open_) {
    open();
  }
  return slots_[slot_].commands;
}

void Batches::open() {
  const std::size_t next = (slot_ + 1) % kSlots;
  Slot& slot = slots_[next];
  wait_for(slot.value);
  on_reuse_(next);
  slot.pool.reset();
  slot.commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  if (*slot.stamps) {
    slot.commands.resetQueryPool(*slot.stamps, 0, kStampsPerBatch);
    slot.commands.writeTimestamp(vk::PipelineStageFlagBits::eTopOfPipe, *slot.stamps, 0);
  }
  slot_ = next;
  is_open_ = true;
  host_reads_ = false;
}

void Batches::submit() {
  if (!is_open_) {
    return;
  }
  Slot& slot = slots_[slot_];
  if (host_reads_) {
    const vk::MemoryBarrier barrier(vk::AccessFlagBits::eTransferWrite, vk::AccessFlagBits::eHostRead);
    slot.commands.pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eHost, {}, barrier,
                                  {}, {});
  }
  if (*slot.stamps) {
    slot.commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *slot.stamps, 1);
  }
  slot.commands.end();
  const std::uint64_t signal = value();
  vk::TimelineSemaphoreSubmitInfo timeline;
  timeline.setSignalSemaphoreValues(signal);
  vk::SubmitInfo info;
  info.setCommandBuffers(*slot.commands);
  info.setSignalSemaphores(*device_.timeline());
  info.pNext = &timeline;
  device_.queue().submit(info);
  submitted_ = signal;
  slot.value = signal;
  slot.has_stamps = static_cast<bool>(*slot.stamps);
  is_open_ = false;
}

void Batches::wait_for(std::uint64_t value) {
  if (value <= done_) {
    return;
  }
  ++wait_count_;
  const auto began = std::chrono::steady_clock::now();
  await(value);
  wait_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

void Batches::await(std::uint64_t value) {
  if (is_done_soon(value)) return;
  const vk::SemaphoreWaitInfo info = wait_info(*device_.timeline(), value);
  if (device_.handle().waitSemaphores(info, to_nanoseconds(wait_limit_s_ - spin_s_)) == vk::Result::eTimeout) {
    throw DeviceError(device_.info().name, "vkWaitSemaphores", timeout_text(wait_limit_s_));
  }
  note_done(value);
}

bool Batches::is_done_soon(std::uint64_t value) {
  using Clock = std::chrono::steady_clock;
  if (spin_s_ <= 0.0) return false;
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(spin_s_));
  do {
    if (done(true) >= value) return true;
  } while (Clock::now() < end);
  return false;
}

std::uint64_t Batches::done(bool ask) {
  if (ask && done_ < submitted_) {
    note_done(device_.timeline().getCounterValue());
  }
  return done_;
}

void Batches::note_done(std::uint64_t value) {
  done_ = std::max(done_, value);
  for (std::size_t i = 0; i < kSlots; ++i) {
    Slot& slot = slots_[(slot_ + 1 + i) % kSlots];  // oldest first, so that the newest is read last
    if (slot.has_stamps && slot.value <= done_) {
      slot.has_stamps = false;
      read_stamps(slot);
    }
  }
}

void Batches::read_stamps(Slot& slot) {
  std::array<std::uint64_t, kStampsPerBatch> stamps{};
  const VkResult result = device_.handle().getDispatcher()->vkGetQueryPoolResults(
      *device_.handle(), *slot.stamps, 0, kStampsPerBatch, sizeof(stamps), stamps.data(), sizeof(stamps[0]),
      VK_QUERY_RESULT_64_BIT);
  if (result == VK_NOT_READY) {
    return;
  }
  check(result, "vkGetQueryPoolResults");
  const std::uint64_t mask =
      device_.timestamp_bits() >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << device_.timestamp_bits()) - 1;
  last_ns_ = static_cast<double>((stamps[1] - stamps[0]) & mask) * device_.info().timestamp_ns;
}

}  // namespace gdtslam
