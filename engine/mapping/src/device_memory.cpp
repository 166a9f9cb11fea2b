#include "device_memory.hpp"

#include <algorithm>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

Buffer allocate_on(Backend& backend, std::size_t bytes) {
  const DeviceInfo& device = backend.device();
  if (bytes > device.max_buffer_bytes) {
    throw DeviceError(device.name, "a buffer of " + std::to_string(bytes) + " bytes",
                      "its limit of " + std::to_string(device.max_buffer_bytes));
  }
  return backend.allocate(bytes);
}

void reserve_on(Backend& backend, Buffer& buffer, std::size_t bytes) {
  if (buffer.bytes() >= bytes) return;
  const std::size_t limit = std::max(bytes, backend.device().max_buffer_bytes);
  constexpr std::size_t kWord = 4;
  buffer = allocate_on(backend, std::min((bytes + bytes / 4 + kWord - 1) / kWord * kWord, limit));
}

}  // namespace gdtslam
