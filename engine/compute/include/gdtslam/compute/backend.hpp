// The seam between the algorithms and the device that runs them. A backend knows five verbs: allocate, upload,
// dispatch, download, and (for the host) a view of the memory where there is one. Dispatches run in the order of the
// calls. A backend and its buffers belong to one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

class Backend;

/// The strongest instruction set of this processor that the kernels are compiled for.
Isa best_isa();
/// Whether the kernels are compiled for it and this processor has it.
bool isa_available(Isa isa);

/// Owning handle of device memory, move-only. Contents are zero after allocation. The backend should outlive it: when
/// it does not, the memory has gone with the backend and the handle is invalid, which every verb refuses.
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
  /// Whether this is a living buffer of that backend.
  [[nodiscard]] bool belongs_to(const Backend& backend) const { return backend_ == &backend && !alive_.expired(); }

 private:
  void reset() noexcept;

  Backend* backend_ = nullptr;
  std::weak_ptr<const char> alive_;
  std::uint64_t id_ = 0;
  std::size_t bytes_ = 0;
};

/// What a device is.
struct DeviceInfo {
  std::string name;    ///< as the driver or the processor names itself
  std::string kind;    ///< "cpu", "lavapipe", "discrete", "integrated"
  std::string driver;  ///< driver and version, or the instruction set in use
  std::size_t max_buffer_bytes = 0;
  unsigned threads = 1;
};

class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  [[nodiscard]] virtual const DeviceInfo& device() const = 0;
  /// Zero-filled memory. Throws Error with the size asked for and the size allowed.
  virtual Buffer allocate(std::size_t bytes) = 0;
  virtual void upload(const Buffer& target, std::span<const std::byte> data, std::size_t offset = 0) = 0;
  /// Runs a kernel over `threads` invocations; a zero extent is a no-op. Buffers are in the order of the bindings.
  virtual void dispatch(const KernelInfo& kernel, std::span<const Buffer* const> buffers,
                        std::span<const std::byte> params, Extent threads) = 0;
  /// Waits for what was dispatched before and copies.
  virtual void download(const Buffer& source, std::span<std::byte> data, std::size_t offset = 0) = 0;
  /// The memory itself where the host shares it (the CPU backend), else empty.
  [[nodiscard]] virtual std::span<std::byte> host_view(const Buffer& buffer) = 0;
  /// Instruction set for work that stays on the host (host_kernels.hpp); the CPU backend answers its own.
  [[nodiscard]] virtual Isa host_isa() const { return best_isa(); }
  /// Dispatches so far.
  [[nodiscard]] virtual std::uint64_t dispatch_count() const = 0;

 private:
  friend class Buffer;
  virtual void release(std::uint64_t id) noexcept = 0;

  std::shared_ptr<const char> alive_ = std::make_shared<const char>('\0');  ///< buffers watch it
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
  std::optional<Isa> isa;  ///< forced instruction set; the strongest there is when empty
};

/// Throws UnavailableError when the processor lacks a forced instruction set.
std::unique_ptr<Backend> make_cpu_backend(const CpuOptions& options);

}  // namespace gdtslam
