// The backend: the calls of compute/backend.hpp on a Vulkan device.

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <thread>

#include "engine.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// Least time for a device that was given up as too slow to release its memory.
constexpr double kLastWait_s = 5.0;

Error make_error(const std::string& message) { return {ExitCode::kFailed, message}; }

DeviceInfo device_info(const Device& device) {
  DeviceInfo info;
  info.name = device.info().name;
  info.kind = device.info().kind;
  info.driver = device.info().driver;
  info.max_buffer_bytes = device.max_buffer_bytes();
  info.threads = info.kind == "lavapipe" ? std::max(1U, std::thread::hardware_concurrency()) : 1;
  return info;
}

/// Pushes the parameters, then the launch's extent if the variant takes it.
void push_params(const vk::raii::CommandBuffer& commands, const VariantPipeline& pipeline, const ShaderVariant& variant,
                 const LaunchShape& shape) {
  std::array<std::byte, kMaxParamsBytes + sizeof(std::uint32_t)> bytes;
  std::copy(shape.params.begin(), shape.params.end(), bytes.begin());
  if (variant.takes_count) {
    std::memcpy(bytes.data() + shape.params.size(), &shape.threads.x, sizeof(shape.threads.x));
  }
  if (const std::uint32_t count = push_constant_bytes(variant, shape.params.size()); count > 0) {
    commands.pushConstants<std::byte>(*pipeline.layout, vk::ShaderStageFlagBits::eCompute, 0,
                                      vk::ArrayProxy<const std::byte>(count, bytes.data()));
  }
}

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
  [[nodiscard]] QueueWork work() const override;
  void copy(const Buffer& source, const Buffer& target) override;
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override;
  void finish_download(PendingDownload download, std::span<std::byte> data) override;
  void flush() override;
  [[nodiscard]] std::span<std::byte> host_view(const Buffer& buffer) override;
  [[nodiscard]] std::uint64_t dispatch_count() const override { return dispatch_count_; }
  [[nodiscard]] std::uint64_t submit_count() const override { return engine_->batches.submitted(); }
  [[nodiscard]] std::size_t pending_downloads() const override { return engine_->transfers.under_way(); }

  [[nodiscard]] const VulkanDeviceInfo& vulkan_device() const override { return engine_->device.info(); }
  [[nodiscard]] double last_submission_ns() const override { return engine_->batches.last_submission_ns(); }
  [[nodiscard]] bool cache_was_loaded() const override { return engine_->pipelines.cache().was_loaded(); }
  bool save_cache() noexcept override;

 private:
  /// Resources that a dispatch binds.
  struct Bound {
    std::array<DeviceBuffer*, kMostBindings> buffers{};
    std::array<std::uint64_t, kMostBindings> ids{};
    std::array<std::size_t, kMostBindings> bytes{};
    std::size_t count = 0;
  };
  void release(std::uint64_t id) noexcept override;
  void forget_download(std::uint64_t id) noexcept override { engine_->transfers.forget(id); }
  DeviceBuffer& find_memory(const Buffer& buffer);
  DeviceBuffer& checked_part(const Buffer& buffer, std::size_t bytes, std::size_t offset, const char* verb);
  Bound bind(const KernelInfo& kernel, std::span<const Buffer* const> buffers);
  void record(const KernelInfo& kernel, const ShaderVariant& variant, const VariantPipeline& pipeline,
              const Bound& bound, const LaunchShape& shape, GroupCount groups);
  void check_groups(const ShaderVariant& variant, GroupCount groups) const;
  void refuse_when_failed() const;
  void throw_validation_messages();
  void collect(bool ask);
  void make_room(std::size_t bytes);
  /// Runs an action with Vulkan calls; after the first DeviceError the backend stops working.
  template <class Action>
  decltype(auto) guarded(Action&& action);

  std::uint64_t lost_at_;
  std::uint64_t steps_ = 0;  // counts the calls of guarded()
  double wait_limit_s_;
  std::unique_ptr<VulkanEngine> engine_;
  DeviceInfo device_info_;
  std::optional<DeviceError> failure_;
  std::uint64_t dispatch_count_ = 0;
  std::map<std::string_view, std::uint64_t> dispatches_;  // by kernel
  std::uint64_t pipelines_saved_ = 0;
};

template <class Action>
decltype(auto) VulkanBackendImpl::guarded(Action&& action) {
  refuse_when_failed();
  try {
    if (++steps_ == lost_at_) throw vk::DeviceLostError("a rehearsed loss");
    return std::forward<Action>(action)();
  } catch (const vk::SystemError& error) {
    failure_ = device_error(device_info_.name, error);
    throw DeviceError(*failure_);
  } catch (const DeviceError& error) {
    failure_ = error;
    throw;
  } catch (const std::bad_alloc&) {
    failure_ = DeviceError(device_info_.name, "operator new", vk::to_string(vk::Result::eErrorOutOfHostMemory));
    throw DeviceError(*failure_);
  }
}

VulkanBackendImpl::VulkanBackendImpl(const VulkanOptions& options)
    : lost_at_(options.lost_at), wait_limit_s_(options.wait_limit_s.value_or(kWaitLimit_s)) {
  device_info_.name = "vulkan";
  guarded([&] { engine_ = std::make_unique<VulkanEngine>(options); });
  device_info_ = device_info(engine_->device);
  throw_validation_messages();
}

VulkanBackendImpl::~VulkanBackendImpl() {
  if (!engine_) {
    return;
  }
  save_cache();
  // The device may still work, even after a simulated loss, and must not lose memory in use: if it does not finish, its
  // memory is kept until the process ends.
  const std::uint64_t last = engine_->batches.submitted();
  const VkSemaphoreWaitInfo wait = wait_info(*engine_->device.timeline(), last);
  const auto limit_ns = to_nanoseconds(std::max(wait_limit_s_, kLastWait_s));
  const vk::raii::Device& device = engine_->device.handle();
  if (last > 0 && device.getDispatcher()->vkWaitSemaphores(*device, &wait, limit_ns) == VK_TIMEOUT) {
    engine_->log.hand_out();
    static_cast<void>(engine_.release());
  }
}

void VulkanBackendImpl::refuse_when_failed() const {
  if (failure_) {
    throw DeviceError(*failure_);
  }
}

void VulkanBackendImpl::throw_validation_messages() {
  const std::string text = engine_->log.take();
  if (text.empty()) {
    return;
  }
  failure_ = DeviceError(device_info_.name, "validation", text);
  throw DeviceError(*failure_);
}

DeviceBuffer& VulkanBackendImpl::find_memory(const Buffer& buffer) {
  if (!buffer.belongs_to(*this)) {
    throw make_error("a buffer was used that is empty, or of another backend, or outlived its own");
  }
  return engine_->buffers.at(buffer.id());
}

DeviceBuffer& VulkanBackendImpl::checked_part(const Buffer& buffer, std::size_t bytes, std::size_t offset,
                                              const char* verb) {
  DeviceBuffer& memory = find_memory(buffer);
  if (offset > memory.bytes || bytes > memory.bytes - offset) {
    throw make_error(std::string(verb) + " of " + std::to_string(bytes) + " bytes at offset " + std::to_string(offset) +
                     " exceeds the buffer's " + std::to_string(memory.bytes) + " bytes");
  }
  return memory;
}

void VulkanBackendImpl::collect(bool ask) {
  const std::uint64_t done = engine_->batches.done(ask);
  engine_->buffers.collect(done);
  engine_->sets.collect(done);
}

// Waits for released memory that the device still uses, but only if the device would run out of memory otherwise.
void VulkanBackendImpl::make_room(std::size_t bytes) {
  if (!engine_->buffers.has_released()) {
    return;
  }
  collect(true);
  if (engine_->buffers.has_released() && engine_->buffers.would_be_tight(bytes)) {
    engine_->batches.submit();
    engine_->batches.wait_for(engine_->batches.submitted());
    collect(false);
  }
}

Buffer VulkanBackendImpl::allocate(std::size_t bytes) {
  refuse_when_failed();
  engine_->buffers.check_size(bytes);  // not guarded: a refused size leaves the backend usable
  const std::uint64_t id = guarded([&] {
    make_room(bytes);
    return engine_->buffers.create(bytes);
  });
  return {*this, id, bytes};
}

void VulkanBackendImpl::release(std::uint64_t id) noexcept {
  engine_->buffers.release(id);
  engine_->sets.drop(id);
}

void VulkanBackendImpl::upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) {
  DeviceBuffer& memory = checked_part(target, data.size(), offset, "upload");
  guarded([&] { engine_->transfers.upload(memory, data, offset); });
}

void VulkanBackendImpl::fill(const Buffer& target, std::uint32_t word) {
  DeviceBuffer& memory = find_memory(target);
  guarded([&] { engine_->transfers.fill(memory, word); });
}

void VulkanBackendImpl::copy(const Buffer& source, const Buffer& target) {
  DeviceBuffer& from = find_memory(source);
  DeviceBuffer& to = find_memory(target);
  if (from.bytes != to.bytes || source.id() == target.id()) {
    throw make_error("a copy of " + std::to_string(from.bytes) + " bytes to " + std::to_string(to.bytes) +
                     " bytes was asked for; it needs two buffers of one size");
  }
  guarded([&] { engine_->transfers.copy(from, to); });
}

PendingDownload VulkanBackendImpl::start_download(const Buffer& source, std::size_t bytes, std::size_t offset) {
  DeviceBuffer& memory = checked_part(source, bytes, offset, "download");
  return pending_download(guarded([&] { return engine_->transfers.start_download(memory, bytes, offset); }), bytes);
}

void VulkanBackendImpl::finish_download(PendingDownload download, std::span<std::byte> data) {
  refuse_when_failed();
  if (!engine_->transfers.is_under_way(download.id, data.size())) {
    throw make_error("a download was asked for that is not under way, or with another size");
  }
  guarded([&] { engine_->transfers.finish_download(download.id, data); });
  collect(false);
  throw_validation_messages();
}

void VulkanBackendImpl::flush() {
  guarded([&] { engine_->batches.submit(); });
  throw_validation_messages();
}

QueueWork VulkanBackendImpl::work() const {
  QueueWork work = engine_->transfers.counts();
  work.dispatches = dispatches_;
  work.submissions = engine_->batches.submitted();
  work.waits = engine_->batches.wait_count();
  work.wait_s = engine_->batches.wait_s();
  work.barriers = engine_->barriers.barrier_count();
  return work;
}

std::span<std::byte> VulkanBackendImpl::host_view(const Buffer& buffer) {
  find_memory(buffer);
  return {};
}

bool VulkanBackendImpl::save_cache() noexcept {
  if (failure_ || engine_->pipelines.made() == pipelines_saved_) {
    return !failure_;
  }
  try {
    const bool is_saved = engine_->pipelines.cache().save();
    pipelines_saved_ = is_saved ? engine_->pipelines.made() : pipelines_saved_;
    return is_saved;
  } catch (...) {  // a cache that cannot be written costs only time at the next start
    return false;
  }
}

VulkanBackendImpl::Bound VulkanBackendImpl::bind(const KernelInfo& kernel, std::span<const Buffer* const> buffers) {
  if (buffers.size() > kMostBindings) {
    throw make_error("kernel " + std::string(kernel.name) + ": " + std::to_string(buffers.size()) +
                     " buffers given, at most " + std::to_string(kMostBindings) + " can be bound");
  }
  Bound bound;
  bound.count = buffers.size();
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    bound.buffers[i] = &find_memory(*buffers[i]);
    bound.ids[i] = buffers[i]->id();
    bound.bytes[i] = bound.buffers[i]->bytes;
    for (std::size_t j = 0; j < i && i < kernel.bindings.size(); ++j) {
      const bool is_written = kernel.bindings[i] != Access::kRead || kernel.bindings[j] != Access::kRead;
      if (is_written && bound.ids[i] == bound.ids[j]) {
        throw make_error("kernel " + std::string(kernel.name) + ": a buffer that is written is bound twice");
      }
    }
  }
  return bound;
}

void VulkanBackendImpl::check_groups(const ShaderVariant& variant, GroupCount groups) const {
  const auto& most = engine_->device.properties().limits.maxComputeWorkGroupCount;
  if (groups.x > most[0] || groups.y > most[1] || groups.z > most[2]) {
    throw DeviceError(device_info_.name, std::string(variant.shader.name),
                      "no launch: " + std::to_string(groups.x) + " x " + std::to_string(groups.y) + " x " +
                          std::to_string(groups.z) + " work groups exceed the limits " + std::to_string(most[0]) +
                          " x " + std::to_string(most[1]) + " x " + std::to_string(most[2]));
  }
}

void VulkanBackendImpl::dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                                 std::span<const std::byte> params, Extent threads) {
  refuse_when_failed();
  Bound bound = bind(kernel, buffers);
  const LaunchShape shape{{bound.bytes.data(), bound.count}, params, threads};
  check_launch(kernel, shape);
  const ShaderVariant& variant = engine_->pipelines.variant_for(kernel, shape);
  if (threads.x == 0 || threads.y == 0 || threads.z == 0) {
    ++dispatch_count_;
    return;
  }
  const GroupCount groups = variant.groups(shape);
  check_groups(variant, groups);
  const VariantPipeline& pipeline =
      guarded([&]() -> const VariantPipeline& { return engine_->pipelines.find_pipeline(kernel, variant); });
  throw_validation_messages();  // a pipeline that does not fit must not be used
  guarded([&] { record(kernel, variant, pipeline, bound, shape, groups); });
  ++dispatch_count_;
}

void VulkanBackendImpl::record(const KernelInfo& kernel, const ShaderVariant& variant, const VariantPipeline& pipeline,
                               const Bound& bound, const LaunchShape& shape, GroupCount groups) {
  const std::span<DeviceBuffer* const> buffers(bound.buffers.data(), bound.count);
  for (DeviceBuffer* buffer : buffers) {
    engine_->transfers.make_ready(*buffer);
  }
  const vk::raii::CommandBuffer& commands = engine_->batches.commands();
  const std::uint64_t batch = engine_->batches.value();
  const vk::DescriptorSet set =
      engine_->sets.set_for(variant, pipeline, {bound.ids.data(), bound.count}, buffers, batch);
  for (std::size_t i = 0; i < bound.count; ++i) {
    engine_->barriers.need(buffers[i]->history, kernel.bindings[i] != Access::kRead);
  }
  engine_->barriers.begin(commands);
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline.pipeline);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline.layout, 0, set, {});
  push_params(commands, pipeline, variant, shape);
  commands.dispatch(groups.x, groups.y, groups.z);
  ++dispatches_[kernel.name];
  for (std::size_t i = 0; i < bound.count; ++i) {
    const Access access = kernel.bindings[i];
    engine_->barriers.note(buffers[i]->history, Stage::kCompute, access != Access::kWrite, access != Access::kRead);
    buffers[i]->last_batch = batch;
  }
}

}  // namespace

std::unique_ptr<VulkanBackend> make_vulkan_backend(const VulkanOptions& options) {
  return std::make_unique<VulkanBackendImpl>(with_environment(options));
}

}  // namespace gdtslam
