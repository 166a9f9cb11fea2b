// The CPU as a device: buffers are host memory, a dispatch runs before the call returns.
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <unordered_map>

#include "engine/compute/cpu/functions.hpp"
#include "engine/compute/cpu/launch.hpp"
#include "engine/core/memory/out_of_memory.hpp"
#include "engine/core/worker_pool.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, and the widest vector
/// Fewer elementary steps than this take less time than waking a thread and waiting for it, which may have lost its
/// core.
constexpr std::uint64_t kStepsWorthThreads = 262144;

std::size_t physical_memory_bytes() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page_bytes = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_bytes <= 0) {
    return std::size_t{1} << 30U;
  }
  return static_cast<std::size_t>(pages) * static_cast<std::size_t>(page_bytes);
}

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  info.exceptions(std::ios::badbit);  // otherwise the stream would hide that memory has run out
  try {
    std::string line;
    while (std::getline(info, line)) {
      const std::size_t colon = line.find(": ");
      if (line.starts_with("model name") && colon != std::string::npos) {
        return line.substr(colon + 2);
      }
    }
  } catch (const std::ios_base::failure&) {  // an unreadable file gives no name
  }
  return "unnamed processor";
}

/// Frees a block from calloc, or this many mapped bytes.
struct FreeDeleter {
  std::size_t mapped_bytes = 0;
  void operator()(std::byte* memory) const {
    if (mapped_bytes == 0) return std::free(memory);
    munmap(memory, mapped_bytes);
  }
};

/// Zeroed memory that starts on a cache line.
struct Allocation {
  std::unique_ptr<std::byte, FreeDeleter> block;
  std::span<std::byte> bytes;
};

Allocation allocate_zeroed(std::size_t bytes) {
  Allocation allocation;
  allocation.block.reset(static_cast<std::byte*>(std::calloc(bytes + kAlignment, 1)));
  if (allocation.block == nullptr) {
    throw OutOfMemory(bytes);
  }
  const auto address = reinterpret_cast<std::uintptr_t>(allocation.block.get());
  const std::size_t lead = (kAlignment - address % kAlignment) % kAlignment;
  allocation.bytes = {allocation.block.get() + lead, bytes};
  return allocation;
}

/// Separate zero pages, which the system provides at the first access; empty if it refuses. Not in large pages, which
/// would be provided whole, nor if the process's address space is limited and this would be much of it.
Allocation reserve_pages(std::size_t bytes) {
  constexpr rlim_t kShare = 8;
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur / kShare < bytes)) {
    return {};
  }
  void* const pages = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (pages == MAP_FAILED) return {};
  madvise(pages, bytes, MADV_NOHUGEPAGE);
  madvise(pages, bytes, MADV_DONTDUMP);
  auto* const memory = static_cast<std::byte*>(pages);
  return {{memory, FreeDeleter{bytes}}, {memory, bytes}};
}

class CpuBackend final : public Backend {
 public:
  CpuBackend(Isa isa, unsigned threads) : isa_(isa), pool_(threads) {
    device_.name = processor_name();
    device_.kind = "cpu";
    device_.driver = to_string(isa);
    device_.max_buffer_bytes = physical_memory_bytes() / 2;
    device_.threads = threads;
  }

  [[nodiscard]] const DeviceInfo& device() const override { return device_; }
  Buffer allocate(std::size_t bytes) override;
  Buffer reserve(std::size_t bytes) override;
  void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) override;
  void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers, std::span<const std::byte> params,
                Extent threads) override;
  void fill(const Buffer& target, std::uint32_t word) override;
  PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset) override;
  void finish_download(PendingDownload download, std::span<std::byte> data) override;
  void flush() override {}
  [[nodiscard]] std::span<std::byte> host_view(const Buffer& buffer) override { return find_memory(buffer); }
  [[nodiscard]] Isa host_isa() const override { return isa_; }
  [[nodiscard]] std::uint64_t dispatch_count() const override { return dispatch_count_; }
  [[nodiscard]] std::uint64_t submit_count() const override { return 0; }
  [[nodiscard]] std::size_t pending_downloads() const override { return downloads_.size(); }

 private:
  void release(std::uint64_t id) noexcept override { allocations_.erase(id); }
  void forget_download(std::uint64_t id) noexcept override { downloads_.erase(id); }
  std::span<std::byte> find_memory(const Buffer& buffer);
  /// The part of a buffer used by a transfer.
  std::span<std::byte> checked_part(const Buffer& buffer, std::size_t bytes, std::size_t offset, const char* verb);
  void bind(const KernelInfo& kernel, std::span<const Buffer* const> buffers);

  Isa isa_;
  WorkerPool pool_;
  DeviceInfo device_;
  std::unordered_map<std::uint64_t, Allocation> allocations_;
  std::uint64_t next_id_ = 1;
  std::uint64_t dispatch_count_ = 0;
  std::unordered_map<std::uint64_t, std::vector<std::byte>> downloads_;  // started, not finished
  std::vector<std::span<std::byte>> bound_;
  std::vector<std::size_t> bound_bytes_;
};

Buffer CpuBackend::allocate(std::size_t bytes) {
  if (bytes > device_.max_buffer_bytes) {
    throw Error(ExitCode::kFailed, "a buffer of " + std::to_string(bytes) +
                                       " bytes was asked for, the largest allowed is " +
                                       std::to_string(device_.max_buffer_bytes));
  }
  const std::uint64_t id = next_id_++;
  allocations_.emplace(id, allocate_zeroed(bytes));
  return {*this, id, bytes};
}

Buffer CpuBackend::reserve(std::size_t bytes) {
  Allocation allocation = reserve_pages(bytes);
  if (allocation.block == nullptr) return {};
  const std::uint64_t id = next_id_++;
  allocations_.emplace(id, std::move(allocation));
  return {*this, id, bytes};
}

std::span<std::byte> CpuBackend::find_memory(const Buffer& buffer) {
  if (!buffer.belongs_to(*this)) {
    throw Error(ExitCode::kFailed, "a buffer was used that is empty, or of another backend, or outlived its own");
  }
  return allocations_.at(buffer.id()).bytes;
}

std::span<std::byte> CpuBackend::checked_part(const Buffer& buffer, std::size_t bytes, std::size_t offset,
                                              const char* verb) {
  const std::span<std::byte> memory = find_memory(buffer);
  if (offset > memory.size() || bytes > memory.size() - offset) {
    throw Error(ExitCode::kFailed, std::string(verb) + " of " + std::to_string(bytes) + " bytes at offset " +
                                       std::to_string(offset) + " exceeds the buffer's " +
                                       std::to_string(memory.size()) + " bytes");
  }
  return memory.subspan(offset, bytes);
}

void CpuBackend::upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset) {
  const std::span<std::byte> part = checked_part(target, data.size(), offset, "upload");
  std::copy(data.begin(), data.end(), part.begin());
}

void CpuBackend::fill(const Buffer& target, std::uint32_t word) {
  const std::span<std::byte> memory = find_memory(target);
  const std::size_t whole = memory.size() / sizeof(word) * sizeof(word);
  for (std::size_t i = 0; i < whole; i += sizeof(word)) std::memcpy(memory.data() + i, &word, sizeof(word));
  std::memcpy(memory.data() + whole, &word, memory.size() - whole);
}

// The copy is made here, so that later dispatches do not change it.
PendingDownload CpuBackend::start_download(const Buffer& source, std::size_t bytes, std::size_t offset) {
  const std::span<std::byte> part = checked_part(source, bytes, offset, "download");
  const std::uint64_t id = next_id_++;
  downloads_.emplace(id, std::vector<std::byte>(part.begin(), part.end()));
  return pending_download(id, bytes);
}

void CpuBackend::finish_download(PendingDownload download, std::span<std::byte> data) {
  const auto found = downloads_.find(download.id);
  if (found == downloads_.end() || data.size() != found->second.size()) {
    throw Error(ExitCode::kFailed, "a download was asked for that is not under way, or with another size");
  }
  std::copy(found->second.begin(), found->second.end(), data.begin());
  downloads_.erase(found);
}

void CpuBackend::bind(const KernelInfo& kernel, std::span<const Buffer* const> buffers) {
  bound_.clear();
  bound_bytes_.clear();
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    bound_.push_back(find_memory(*buffers[i]));
    bound_bytes_.push_back(bound_.back().size());
    for (std::size_t j = 0; j < i && i < kernel.bindings.size(); ++j) {
      const bool written = kernel.bindings[i] != Access::kRead || kernel.bindings[j] != Access::kRead;
      if (written && buffers[i]->id() == buffers[j]->id()) {
        refuse_launch(kernel.name, "a buffer that is written is bound twice");
      }
    }
  }
}

void CpuBackend::dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                          std::span<const std::byte> params, Extent threads) {
  bind(kernel, buffers);
  const LaunchShape shape{bound_bytes_, params, threads};
  check_launch(kernel, shape);
  const CpuFunction function = kernel.cpu[static_cast<std::size_t>(isa_)];
  ++dispatch_count_;
  if (threads.x == 0 || threads.y == 0 || threads.z == 0) {
    return;
  }
  const std::uint32_t count = threads.y > 1 ? threads.y : threads.x;
  const CpuLaunch launch{bound_, params, threads, 0, count};
  if (pool_.threads() == 1 || count == 1 || kernel.work(shape) < kStepsWorthThreads) {
    function(launch);
    return;
  }
  // Slices along x end at cache lines even for bytes, so that two threads do not write into one line.
  const bool wide = threads.y <= 1 && count >= 2 * kAlignment * pool_.threads();
  pool_.run(count, wide ? kAlignment : 1, [function, &launch](std::uint64_t begin, std::uint64_t end) {
    CpuLaunch slice = launch;
    slice.begin = static_cast<std::uint32_t>(begin);
    slice.end = static_cast<std::uint32_t>(end);
    function(slice);
  });
}

}  // namespace

std::unique_ptr<Backend> make_cpu_backend(const CpuOptions& options) {
  const Isa isa = options.isa.value_or(best_isa());
  if (!isa_available(isa)) {
    throw UnavailableError("instruction set " + std::string(to_string(isa)) +
                           " is not available on this processor; the best is " + std::string(to_string(best_isa())));
  }
  return std::make_unique<CpuBackend>(isa, threads_meant(options.threads));
}

}  // namespace gdtslam
