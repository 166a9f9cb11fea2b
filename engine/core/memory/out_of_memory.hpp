// The error of memory that ended where the size asked for is known; elsewhere it is std::bad_alloc.
#pragma once

#include <cstddef>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// A buffer that the host has no memory for (exit 1). A command adds what needs less.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(std::size_t bytes)
      : Error(ExitCode::kFailed, "cannot allocate a buffer of " + std::to_string(bytes) + " bytes: out of memory") {}
};

}  // namespace gdtslam
