#include "queued_backend.hpp"

#include <algorithm>
#include <stdexcept>

#include "gdtslam/core/error.hpp"

namespace gdtslam::test {

QueuedBackend::QueuedBackend(std::uint64_t fail_at) : cpu_(make_cpu_backend({})), fail_at_(fail_at) {
  device_.name = "queued";
  device_.kind = "discrete";
  device_.driver = "test";
  device_.max_buffer_bytes = std::size_t{1} << 31U;
}

QueuedBackend::~QueuedBackend() { memory_.clear(); }

void QueuedBackend::enter(std::string_view call) {
  const bool failed_before = fail_at_ != 0 && calls_.size() >= fail_at_;
  calls_after_failure_ += failed_before ? 1 : 0;
  if (!failed_before) calls_.emplace_back(call);
  if (fail_at_ != 0 && calls_.size() >= fail_at_) throw DeviceError(device_.name, calls_.back(), "ErrorDeviceLost");
}

void QueuedBackend::submit() {
  if (line_.empty()) return;
  ++submissions_;
  for (const auto& work : line_) work();
  line_.clear();
}

QueuedBackend::Memory QueuedBackend::memory_of(const Buffer& buffer) const {
  if (!buffer.belongs_to(*this)) throw std::logic_error("a buffer of another backend");
  return memory_.at(buffer.id());
}

void QueuedBackend::release(std::uint64_t id) noexcept { memory_.erase(id); }

Buffer QueuedBackend::allocate(std::size_t bytes) {
  enter("allocate");
  if (bytes > device_.max_buffer_bytes) throw DeviceError(device_.name, "allocate", "too large a buffer");
  const std::uint64_t id = next_id_++;
  memory_.emplace(id, std::make_shared<Buffer>(cpu_->allocate(bytes)));
  return {*this, id, bytes};
}

void QueuedBackend::upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) {
  enter("upload");
  line_.emplace_back([this, memory = memory_of(target), copy = std::vector<std::byte>(data.begin(), data.end()),
                      offset] { cpu_->upload(*memory, copy, offset); });
}

void QueuedBackend::fill(const Buffer& target, std::uint32_t word) {
  enter("fill");
  line_.emplace_back([this, memory = memory_of(target), word] { cpu_->fill(*memory, word); });
}

void QueuedBackend::dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                             std::span<const std::byte> params, Extent threads) {
  enter(kernel.name);
  ++dispatches_;
  std::vector<Memory> bound;
  for (const Buffer* buffer : buffers) bound.push_back(memory_of(*buffer));
  line_.emplace_back([this, &kernel, bound, copy = std::vector<std::byte>(params.begin(), params.end()), threads] {
    std::vector<const Buffer*> list;
    for (const Memory& memory : bound) list.push_back(memory.get());
    cpu_->dispatch(kernel, list, copy, threads);
  });
}

PendingDownload QueuedBackend::start_download(const Buffer& source, std::size_t bytes, std::size_t offset) {
  enter("start_download");
  const std::uint64_t id = next_id_++;
  downloads_.try_emplace(id).first->second.content.resize(bytes);
  line_.emplace_back([this, memory = memory_of(source), offset, id] {
    const auto found = downloads_.find(id);
    if (found == downloads_.end()) return;  // forgotten meanwhile
    cpu_->download(*memory, found->second.content, offset);
    found->second.has_arrived = true;
  });
  return pending_download(id, bytes);
}

void QueuedBackend::finish_download(PendingDownload download, std::span<std::byte> data) {
  enter("finish_download");
  if (!downloads_.at(download.id).has_arrived) submit();
  const std::vector<std::byte>& found = downloads_.at(download.id).content;
  if (found.size() != data.size()) throw std::logic_error("a download of another size");
  std::copy(found.begin(), found.end(), data.begin());
  downloads_.erase(download.id);
}

void QueuedBackend::flush() {
  enter("flush");
  submit();
}

}  // namespace gdtslam::test
