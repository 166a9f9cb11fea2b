// Memory of a device for the mapper's buffers.
#pragma once

#include <algorithm>
#include <cstddef>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// Replaces a buffer that is too small by a larger one, with spare room; its content is lost.
inline void reserve_on(Backend& backend, Buffer& buffer, std::size_t bytes) {
  if (buffer.bytes() >= bytes) return;
  const std::size_t limit = std::max(bytes, backend.device().max_buffer_bytes);
  constexpr std::size_t kWord = 4;
  buffer = backend.allocate(std::min((bytes + bytes / 4 + kWord - 1) / kWord * kWord, limit));
}

}  // namespace gdtslam
