// Returns pages of memory to the system. Thread-safe.
#pragma once

#include <cstddef>
#include <span>

namespace gdtslam {

/// Zeroes memory that the system gave zeroed; whole pages return to the system until they are touched. Not for memory
/// of a file or shared memory.
void forget(std::span<std::byte> memory);

}  // namespace gdtslam
