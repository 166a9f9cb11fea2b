#include <utility>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

Buffer::Buffer(Backend& backend, std::uint64_t id, std::size_t bytes)
    : backend_(&backend), alive_(backend.alive_), id_(id), bytes_(bytes) {}

Buffer::Buffer(Buffer&& other) noexcept
    : backend_(std::exchange(other.backend_, nullptr)),
      alive_(std::move(other.alive_)),
      id_(std::exchange(other.id_, 0)),
      bytes_(std::exchange(other.bytes_, 0)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this != &other) {
    reset();
    backend_ = std::exchange(other.backend_, nullptr);
    alive_ = std::move(other.alive_);
    id_ = std::exchange(other.id_, 0);
    bytes_ = std::exchange(other.bytes_, 0);
  }
  return *this;
}

Buffer::~Buffer() { reset(); }

void Buffer::reset() noexcept {
  if (valid()) {
    backend_->release(id_);
  }
  backend_ = nullptr;
}

PendingDownload Backend::pending_download(std::uint64_t id, std::size_t bytes) {
  const auto forget = [backend = this, alive = std::weak_ptr<const char>(alive_), id](const void*) noexcept {
    if (!alive.expired()) {
      backend->forget_download(id);
    }
  };
  return {id, bytes, std::shared_ptr<const void>(this, forget)};
}

}  // namespace gdtslam
