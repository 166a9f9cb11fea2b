// A backend that claims to be a discrete GPU and secretly has the CPU do its work, in several ways: what a check that a
// device computes by itself must find out. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

/// What else it does wrong. It always counts dispatches and submissions as a device would.
enum class Trick : std::uint8_t {
  kNone,           ///< calls the CPU functions of the kernel that it is given
  kOwnRegistry,    ///< calls those of the registry, whatever it is given
  kShowsMemory,    ///< lets the host see its memory
  kCountsNothing,  ///< counts no submission
  kWrongValue,     ///< the last word of the last buffer is wrong after a dispatch
  kWritesGuard,    ///< writes behind the last buffer's content
  kWritesInput,    ///< changes the first buffer
};

class SecretCpu final : public Backend {
 public:
  /// From dispatch number `first_trick` on (from 0) it does what `trick` says.
  explicit SecretCpu(Trick trick, std::uint64_t first_trick = 0);

  [[nodiscard]] const DeviceInfo& device() const override { return device_; }
  Buffer allocate(std::size_t bytes) override;
  void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) override;
  void fill(const Buffer& target, std::uint32_t word) override;
  void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> params,
                Extent threads) override;
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override;
  void finish_download(PendingDownload download, std::span<std::byte> data) override;
  void flush() override {}
  [[nodiscard]] std::span<std::byte> host_view(const Buffer& buffer) override;
  [[nodiscard]] std::uint64_t dispatch_count() const override { return dispatches_; }
  [[nodiscard]] std::uint64_t submit_count() const override { return trick_ == Trick::kCountsNothing ? 0 : submits_; }
  [[nodiscard]] std::size_t pending_downloads() const override { return cpu_->pending_downloads(); }

 private:
  void release(std::uint64_t id) noexcept override { buffers_.erase(id); }
  void forget_download(std::uint64_t) noexcept override {}  // the handles are the inner backend's
  void spoil(std::span<const Buffer* const> inner);
  const Buffer& inner(const Buffer& outer) const { return buffers_.at(outer.id()); }

  Trick trick_;
  std::uint64_t first_trick_;
  std::unique_ptr<Backend> cpu_;
  DeviceInfo device_;
  std::map<std::uint64_t, Buffer> buffers_;
  std::uint64_t next_id_ = 1;
  std::uint64_t dispatches_ = 0;
  std::uint64_t submits_ = 0;
};

}  // namespace gdtslam::test
