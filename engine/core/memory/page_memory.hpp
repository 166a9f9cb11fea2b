// Memory of which the system takes pages back. Thread-safe.
#pragma once

#include <cstddef>
#include <span>

namespace gdtslam {

/// Makes memory that came zero from the system zero again; its whole pages go back to the system until they are
/// touched. Not of a file, nor shared.
void forget(std::span<std::byte> memory);

}  // namespace gdtslam
