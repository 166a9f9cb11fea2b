#include "secret_cpu.hpp"

#include <algorithm>

namespace gdtslam::test {
namespace {

constexpr std::size_t kGuardBytes = 256;  // what run_case() puts behind each buffer

}  // namespace

SecretCpu::SecretCpu(Trick trick, std::uint64_t first_trick)
    : trick_(trick), first_trick_(first_trick), cpu_(make_cpu_backend({})), device_(cpu_->device()) {
  device_.name = "GPU of a test";
  device_.kind = "discrete";
  device_.driver = "none";
}

Buffer SecretCpu::allocate(std::size_t bytes) {
  const std::uint64_t id = next_id_++;
  buffers_.emplace(id, cpu_->allocate(bytes));
  return {*this, id, bytes};
}

void SecretCpu::upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) {
  cpu_->upload(inner(target), data, offset);
}

void SecretCpu::fill(const Buffer& target, std::uint32_t word) { cpu_->fill(inner(target), word); }

void SecretCpu::dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                         std::span<const std::byte> params, Extent threads) {
  std::vector<const Buffer*> bound;
  for (const Buffer* buffer : buffers) bound.push_back(&inner(*buffer));
  const KernelInfo* const own = trick_ == Trick::kOwnRegistry ? find_kernel(kernel.name) : nullptr;
  cpu_->dispatch(own != nullptr ? *own : kernel, bound, params, threads);
  if (dispatches_ >= first_trick_) spoil(bound);
  ++dispatches_;
  ++submits_;
}

void SecretCpu::spoil(std::span<const Buffer* const> inner) {
  const std::span<std::byte> first = cpu_->host_view(*inner.front());
  const std::span<std::byte> last = cpu_->host_view(*inner.back());
  const std::size_t content = last.size() - std::min(last.size(), kGuardBytes);
  if (trick_ == Trick::kWrongValue && content > 0) last[content - 1] ^= std::byte{1};
  if (trick_ == Trick::kWritesGuard && content < last.size()) last[content] ^= std::byte{1};
  if (trick_ == Trick::kWritesInput && first.size() > kGuardBytes) first.front() ^= std::byte{1};
}

PendingDownload SecretCpu::start_download(const Buffer& source, std::size_t bytes, std::size_t offset) {
  return cpu_->start_download(inner(source), bytes, offset);
}

void SecretCpu::finish_download(PendingDownload download, std::span<std::byte> data) {
  cpu_->finish_download(download, data);
}

std::span<std::byte> SecretCpu::host_view(const Buffer& buffer) {
  return trick_ == Trick::kShowsMemory ? cpu_->host_view(inner(buffer)) : std::span<std::byte>{};
}

}  // namespace gdtslam::test
