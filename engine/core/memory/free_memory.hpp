// Returns freed memory to the system if the C library can do that: it keeps pages between used blocks, and more of them
// with each thread. Takes milliseconds; call it after much was freed. Thread-safe.
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

/// Call at the start of processes that run for hours: from now on freed blocks of 256 KiB and more return to the system
/// at once. Otherwise the C library would keep the space of the largest between other blocks. Costs a page fault for
/// each of their pages.
inline void return_large_blocks_at_once() {
#ifdef __GLIBC__
  ::mallopt(M_MMAP_THRESHOLD, 256 << 10);
  ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
#endif
}

}  // namespace gdtslam
