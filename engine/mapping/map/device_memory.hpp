// Memory of a device for the mapper's buffers.
#pragma once

#include <cstddef>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

/// Makes a buffer that is too small larger, with room to spare; what it held is lost.
void reserve_on(Backend& backend, Buffer& buffer, std::size_t bytes);

}  // namespace gdtslam
