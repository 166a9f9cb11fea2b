// Interface between the algorithms and the device that runs them. A backend has few operations: allocate, upload, fill,
// dispatch, download, flush, and (for the host) a view of shared memory. Work is done in the order of the calls. A
// device queues the work and starts it at flush() or when the caller waits for a download, so all work between two such
// calls is one submission. A backend and its buffers belong to one thread at a time. Every operation throws DeviceError
// if the device fails; such a backend refuses all further work, and can only be destroyed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

class Backend;

/// The strongest instruction set of this processor for which the kernels are compiled.
Isa best_isa();
/// True if the kernels are compiled for it and this processor has it.
bool isa_available(Isa isa);

/// Owning handle of device memory, move-only. Contents are zero after allocation. The backend should outlive it:
/// otherwise the memory is freed with the backend, and the handle becomes invalid, which every operation refuses.
class Buffer {
 public:
  Buffer() = default;
  Buffer(Backend& backend, std::uint64_t id, std::size_t bytes);
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();

  [[nodiscard]] std::uint64_t id() const { return id_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] bool valid() const { return backend_ != nullptr && !alive_.expired(); }
  /// True if this is a valid buffer of that backend.
  [[nodiscard]] bool belongs_to(const Backend& backend) const { return backend_ == &backend && !alive_.expired(); }

 private:
  void reset() noexcept;

  Backend* backend_ = nullptr;
  std::weak_ptr<const char> alive_;
  std::uint64_t id_ = 0;
  std::size_t bytes_ = 0;
};

/// Description of a device.
struct DeviceInfo {
  std::string name;  ///< name given by the driver or the processor
  /// "cpu" (the CPU backend and no other: the host sees its memory), "lavapipe", "discrete", "integrated", "virtual",
  /// "other".
  std::string kind;
  std::string driver;  ///< driver and version, or the instruction set in use
  std::size_t max_buffer_bytes = 0;
  unsigned threads = 1;
};

/// A download in progress. Backend::finish_download() delivers it once. If its last copy is destroyed before that, the
/// backend drops the download. The backend may be destroyed first.
struct PendingDownload {
  std::uint64_t id = 0;
  std::size_t bytes = 0;
  std::shared_ptr<const void> owner = nullptr;  ///< makes the backend forget it with the last copy
};

/// Work of a device so far, counted on its queue. The difference of two is the work in between.
struct QueueWork {
  std::map<std::string_view, std::uint64_t> dispatches;  ///< by kernel, without empty launches
  std::uint64_t submissions = 0;
  std::uint64_t waits = 0;     ///< waits of the host for submissions not known to be done
  double wait_s = 0.0;         ///< their time
  std::uint64_t barriers = 0;  ///< needed by the kernels' bindings and the transfers
  std::uint64_t fills = 0;     ///< includes zeroing of new buffers
  std::uint64_t uploads = 0;
  std::uint64_t upload_bytes = 0;
  std::uint64_t downloads = 0;  ///< copies by the device for the host
  std::uint64_t download_bytes = 0;

  [[nodiscard]] std::uint64_t dispatch_sum() const;
};
/// Difference by member; `before` must be the earlier one.
QueueWork operator-(const QueueWork& now, const QueueWork& before);
QueueWork& operator+=(QueueWork& sum, const QueueWork& more);

/// Buffers and kernels on one device, the CPU or a GPU.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  [[nodiscard]] virtual const DeviceInfo& device() const = 0;
  /// Zero-filled memory. Throws Error with the requested size and the limit.
  virtual Buffer allocate(std::size_t bytes) = 0;
  /// Address space whose pages get memory at the first access and read as zero before. Invalid on a device, and if the
  /// process may not have this much; then request less.
  virtual Buffer reserve(std::size_t /*bytes*/) { return {}; }
  /// The data are copied before the call returns. Offset and size are multiples of 4, or the last bytes of the buffer.
  virtual void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset = 0) = 0;
  /// Sets every 32-bit word of a buffer, including the bytes after the last whole word.
  virtual void fill(const Buffer& target, std::uint32_t word) = 0;
  /// Runs a kernel over `threads` invocations; a zero extent is a no-op. Buffers are in the order of the bindings.
  virtual void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                        std::span<const std::byte> params, Extent threads) = 0;
  /// Queues the copy of a part of a buffer behind all earlier work.
  virtual PendingDownload start_download(const Buffer& source, std::size_t bytes, std::size_t offset = 0) = 0;
  /// Waits for a download and delivers it; `data` has its size. Starts queued work if necessary.
  virtual void finish_download(PendingDownload download, std::span<std::byte> data) = 0;
  /// Waits for all earlier work and copies.
  void download(const Buffer& source, std::span<std::byte> data, std::size_t offset = 0) {
    finish_download(start_download(source, data.size(), offset), data);
  }
  /// Starts the queued work and returns immediately.
  virtual void flush() = 0;
  /// The memory itself if the host shares it (the CPU backend), else empty.
  [[nodiscard]] virtual std::span<std::byte> host_view(const Buffer& buffer) = 0;
  /// Instruction set for work on the host (host_kernels.hpp); the CPU backend returns its own.
  [[nodiscard]] virtual Isa host_isa() const { return best_isa(); }
  /// Number of dispatches so far.
  [[nodiscard]] virtual std::uint64_t dispatch_count() const = 0;
  /// Number of submissions so far; a device that works immediately, like the CPU, counts none.
  [[nodiscard]] virtual std::uint64_t submit_count() const = 0;
  /// Work of the device so far; none for one that works immediately, like the CPU.
  [[nodiscard]] virtual QueueWork work() const { return {}; }
  /// Number of downloads that were started, and neither finished nor forgotten.
  [[nodiscard]] virtual std::size_t pending_downloads() const = 0;

 protected:
  /// The handle of a download that was started: calls forget_download() when its last copy goes.
  PendingDownload pending_download(std::uint64_t id, std::size_t bytes);

 private:
  friend class Buffer;
  virtual void release(std::uint64_t id) noexcept = 0;
  /// Also called for finished downloads, and after the device has failed; it must not use the device.
  virtual void forget_download(std::uint64_t id) noexcept = 0;

  std::shared_ptr<const char> alive_ = std::make_shared<const char>('\0');  ///< buffers and downloads watch it
};

/// Typed call: parameters by value, one buffer per binding.
template <class K, class... Buffers>
void run(Backend& backend, const typename K::Params& params, Extent threads, const Buffers&... buffers) {
  static_assert(sizeof...(Buffers) == K::kBindings.size(), "one buffer per binding");
  const Buffer* const list[] = {&buffers...};
  backend.dispatch(K::info(), list, std::as_bytes(std::span(&params, 1)), threads);
}

/// Options of the CPU backend.
struct CpuOptions {
  unsigned threads = 1;    ///< 0: one per processor
  std::optional<Isa> isa;  ///< forced instruction set; empty: the strongest available
};

/// Calls of CPU kernels so far in this process, on all threads: a dispatch on the CPU counts one or more (one per
/// slice), and so does a call of host_kernels.hpp. If a device leaves it unchanged, it has used no CPU kernel.
/// Thread-safe; calls of other threads that are not synchronised with the caller may be missing.
std::uint64_t cpu_kernel_calls();

/// Throws UnavailableError if the processor lacks a forced instruction set.
std::unique_ptr<Backend> make_cpu_backend(const CpuOptions& options);

}  // namespace gdtslam
