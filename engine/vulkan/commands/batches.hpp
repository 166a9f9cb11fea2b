// Rotating command buffers: commands are recorded into the open one until it is submitted, a few are in flight, and one
// timeline semaphore shows which are done.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "engine/vulkan/device/device.hpp"

namespace gdtslam {

class Batches {
 public:
  static constexpr std::size_t kSlots = 3;

  /// A wait polls for spin_s seconds before it sleeps; more than wait_limit_s is an error.
  Batches(const Device& device, double wait_limit_s, double spin_s);

  /// Sets a callback that receives the slot of a finished batch before its memory is reused.
  void set_on_reuse(std::function<void(std::size_t)> on_reuse) { on_reuse_ = std::move(on_reuse); }

  /// The open command buffer; opens one if needed, which may wait for the oldest batch.
  const vk::raii::CommandBuffer& commands();
  /// Slot and timeline value of the open batch.
  [[nodiscard]] std::size_t slot() const { return slot_; }
  [[nodiscard]] std::uint64_t value() const { return submitted_ + 1; }
  /// Announces that the host will read copies of the open batch.
  void deliver_to_host() { host_reads_ = true; }

  /// Submits the open batch; does nothing without one.
  void submit();
  /// Waits for a submitted batch; beyond the limit it throws DeviceError.
  void wait_for(std::uint64_t value);
  /// The last batch known to be done; `ask` queries the device.
  std::uint64_t done(bool ask);
  [[nodiscard]] std::uint64_t submitted() const { return submitted_; }
  /// Number of waits for batches not known to be done.
  [[nodiscard]] std::uint64_t wait_count() const { return wait_count_; }
  /// Time of these waits.
  [[nodiscard]] double wait_s() const { return wait_s_; }
  [[nodiscard]] double last_submission_ns() const { return last_ns_; }

 private:
  struct Slot {
    vk::raii::CommandPool pool{nullptr};
    vk::raii::CommandBuffer commands{nullptr};
    vk::raii::QueryPool stamps{nullptr};
    std::uint64_t value = 0;  ///< timeline value of its last submission
    bool has_stamps = false;  ///< timestamps written, not yet read
  };
  static Slot make_slot(const Device& device);
  void open();
  void await(std::uint64_t value);
  [[nodiscard]] bool is_done_soon(std::uint64_t value);
  void note_done(std::uint64_t value);
  void read_stamps(Slot& slot);

  const Device& device_;
  double wait_limit_s_;
  double spin_s_;  ///< part of the limit
  std::function<void(std::size_t)> on_reuse_;
  std::array<Slot, kSlots> slots_;
  std::size_t slot_ = kSlots - 1;
  bool is_open_ = false;
  bool host_reads_ = false;
  std::uint64_t submitted_ = 0;
  std::uint64_t done_ = 0;
  std::uint64_t wait_count_ = 0;
  double wait_s_ = 0.0;
  double last_ns_ = 0.0;
};

/// Converts a wait limit to the API's nanoseconds.
std::uint64_t to_nanoseconds(double seconds);
/// The wait for a value of the timeline.
vk::SemaphoreWaitInfo wait_info(const vk::Semaphore& timeline, const std::uint64_t& value);

}  // namespace gdtslam
