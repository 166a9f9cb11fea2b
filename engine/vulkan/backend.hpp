// The backend: the verbs of compute/backend.hpp on a Vulkan device.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "engine.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

class VulkanBackendImpl final : public VulkanBackend {
 public:
  explicit VulkanBackendImpl(const VulkanOptions& options);
  ~VulkanBackendImpl() override;
  VulkanBackendImpl(const VulkanBackendImpl&) = delete;
  VulkanBackendImpl& operator=(const VulkanBackendImpl&) = delete;

  [[nodiscard]] const DeviceInfo& device() const override { return device_info_; }
  Buffer allocate(std::size_t bytes) override;
  void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) override;
  void fill(const Buffer& target, std::uint32_t word) override;
  void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> params,
                Extent threads) override;
  void copy(const Buffer& source, const Buffer& target) override;
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override;
  void finish_download(PendingDownload download, std::span<std::byte> data) override;
  void flush() override;
  [[nodiscard]] std::span<std::byte> host_view(const Buffer& buffer) override;
  [[nodiscard]] std::uint64_t dispatch_count() const override { return dispatch_count_; }
  [[nodiscard]] std::uint64_t submit_count() const override { return engine_->batches.submitted(); }
  [[nodiscard]] std::size_t pending_downloads() const override { return engine_->transfers.under_way(); }

  [[nodiscard]] const VulkanDeviceInfo& vulkan_device() const override { return engine_->device.info(); }
  [[nodiscard]] std::uint64_t call_count() const override { return calls_.count(); }
  [[nodiscard]] double last_submission_ns() const override { return engine_->batches.last_submission_ns(); }
  [[nodiscard]] std::uint64_t barrier_count() const override { return engine_->barriers.barrier_count(); }
  [[nodiscard]] bool cache_was_loaded() const override { return engine_->pipelines.cache().was_loaded(); }
  bool save_cache() noexcept override;

 private:
  /// What a dispatch binds.
  struct Bound {
    std::array<DeviceBuffer*, kMostBindings> buffers{};
    std::array<std::uint64_t, kMostBindings> ids{};
    std::array<std::size_t, kMostBindings> bytes{};
    std::size_t count = 0;
  };
  void release(std::uint64_t id) noexcept override;
  void forget_download(std::uint64_t id) noexcept override { engine_->transfers.forget(id); }
  DeviceBuffer& memory_of(const Buffer& buffer);
  DeviceBuffer& part_of(const Buffer& buffer, std::size_t bytes, std::size_t offset, const char* verb);
  Bound bind(const KernelInfo& kernel, std::span<const Buffer* const> buffers);
  void record(const KernelInfo& kernel, const ShaderVariant& variant, const VariantPipeline& pipeline,
              const Bound& bound, const LaunchShape& shape, GroupCount groups);
  void check_groups(const ShaderVariant& variant, GroupCount groups) const;
  void refuse_when_failed() const;
  void throw_validation_messages();
  void collect(bool ask);
  void make_room(std::size_t bytes);
  /// Runs what calls Vulkan; the first DeviceError ends the backend's life as a worker.
  template <class Action>
  decltype(auto) guarded(Action&& action);

  DriverCalls calls_;
  double wait_limit_s_;
  std::unique_ptr<VulkanEngine> engine_;
  DeviceInfo device_info_;
  std::optional<DeviceError> failure_;
  std::uint64_t dispatch_count_ = 0;
  std::uint64_t pipelines_saved_ = 0;
};

}  // namespace gdtslam
