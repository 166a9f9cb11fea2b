// Returns freed memory to the system if the C library can do that: it keeps pages between blocks that are still used,
// more of them with each thread. Milliseconds; for moments at which much was freed. Thread-safe.
#pragma once

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gdtslam {

inline void return_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

/// For processes that go on for hours, at their start: from now on blocks of 256 KiB and more are the system's again as
/// soon as they are freed, where the C library would keep the room of the largest between blocks that stay. Costs a
/// page fault for each of their pages.
inline void return_large_blocks_at_once() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 256 << 10);
  ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
#endif
}

}  // namespace gdtslam
