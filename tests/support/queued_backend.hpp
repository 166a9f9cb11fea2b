// A device without a device: work is collected and done by the CPU's kernels when it is flushed or waited for, the host
// sees none of the memory, submissions are counted, and the k-th call can be made to fail as a lost device does. For
// tests of what uses a backend.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

class QueuedBackend final : public Backend {
 public:
  /// The call number `fail_at` (from 1) throws DeviceError, and so does every later one; 0: none.
  explicit QueuedBackend(std::uint64_t fail_at = 0);
  ~QueuedBackend() override;

  /// What was called, in order: "allocate", "upload", "fill", the kernel's name, "start_download", "finish_download",
  /// "flush". The call that failed is the last one.
  [[nodiscard]] const std::vector<std::string>& calls() const { return calls_; }
  /// Calls after the one that failed.
  [[nodiscard]] std::uint64_t calls_after_failure() const { return calls_after_failure_; }
  /// Bytes of the largest buffer, as a device may have it.
  void set_max_buffer_bytes(std::size_t bytes) { device_.max_buffer_bytes = bytes; }

  [[nodiscard]] const DeviceInfo& device() const override { return device_; }
  Buffer allocate(std::size_t bytes) override;
  void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) override;
  void fill(const Buffer& target, std::uint32_t word) override;
  void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> params,
                Extent threads) override;
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override;
  void finish_download(PendingDownload download, std::span<std::byte> data) override;
  void flush() override;
  [[nodiscard]] std::span<std::byte> host_view(const Buffer&) override { return {}; }
  [[nodiscard]] std::uint64_t dispatch_count() const override { return dispatches_; }
  [[nodiscard]] std::uint64_t submit_count() const override { return submissions_; }
  [[nodiscard]] std::size_t pending_downloads() const override { return downloads_.size(); }

 private:
  using Memory = std::shared_ptr<Buffer>;  // of the CPU backend; work in line keeps it alive
  struct Download {
    std::vector<std::byte> content;
    bool has_arrived = false;
  };

  void release(std::uint64_t id) noexcept override;
  void forget_download(std::uint64_t id) noexcept override { downloads_.erase(id); }
  void enter(std::string_view call);
  void submit();
  [[nodiscard]] Memory memory_of(const Buffer& buffer) const;

  DeviceInfo device_;
  std::unique_ptr<Backend> cpu_;
  std::uint64_t fail_at_;
  std::uint64_t next_id_ = 1;
  std::uint64_t dispatches_ = 0;
  std::uint64_t submissions_ = 0;
  std::uint64_t calls_after_failure_ = 0;
  std::vector<std::string> calls_;
  std::unordered_map<std::uint64_t, Memory> memory_;
  std::unordered_map<std::uint64_t, Download> downloads_;
  std::vector<std::function<void()>> line_;
};

}  // namespace gdtslam::test
