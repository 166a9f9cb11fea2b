// A CPU that says that it has little memory.
#pragma once

#include <memory>
#include <utility>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

/// A CPU with so small a largest buffer that no search window fits, and without address space to spare (reserve());
/// buffers and downloads are those of a real one.
class SmallCpu final : public Backend {
 public:
  SmallCpu() : device_(cpu_->device()) { device_.max_buffer_bytes = 1000; }

  [[nodiscard]] const DeviceInfo& device() const override { return device_; }
  Buffer allocate(std::size_t bytes) override { return cpu_->allocate(bytes); }
  void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) override {
    cpu_->upload(target, data, offset);
  }
  void fill(const Buffer& target, std::uint32_t word) override { cpu_->fill(target, word); }
  void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> params,
                Extent threads) override {
    cpu_->dispatch(kernel, buffers, params, threads);
  }
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override {
    return cpu_->start_download(source, bytes, offset);
  }
  void finish_download(PendingDownload download, std::span<std::byte> data) override {
    cpu_->finish_download(std::move(download), data);
  }
  void flush() override { cpu_->flush(); }
  [[nodiscard]] std::span<std::byte> host_view(const Buffer& buffer) override { return cpu_->host_view(buffer); }
  [[nodiscard]] std::uint64_t dispatch_count() const override { return cpu_->dispatch_count(); }
  [[nodiscard]] std::uint64_t submit_count() const override { return cpu_->submit_count(); }
  [[nodiscard]] std::size_t pending_downloads() const override { return cpu_->pending_downloads(); }

 private:
  void release(std::uint64_t /*id*/) noexcept override {}
  void forget_download(std::uint64_t /*id*/) noexcept override {}

  std::unique_ptr<Backend> cpu_ = make_cpu_backend({});
  DeviceInfo device_;
};

}  // namespace gdtslam::test
