// The error if memory ran out and the requested size is known; otherwise it is std::bad_alloc.
#pragma once

#include <cstddef>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// The host has no memory for a buffer (exit 1). A command adds advice on using less.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(std::size_t bytes)
      : Error(ExitCode::kFailed, "cannot allocate a buffer of " + std::to_string(bytes) + " bytes: out of memory") {}
};

}  // namespace gdtslam
