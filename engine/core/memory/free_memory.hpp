// What was freed piece by piece goes back to the system, where the C library can do that: it keeps pages between blocks
// that are still used, more of them with each thread. Milliseconds; for moments at which much was freed. Thread-safe.
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

}  // namespace gdtslam
