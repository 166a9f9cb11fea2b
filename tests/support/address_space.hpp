// Whether a process may take as much address space as it likes: where it may not, pieces that a map or a backend
// reserves are smaller, or are not there.
#pragma once

#include <sys/resource.h>

namespace gdtslam::test {

inline bool is_address_space_bounded() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace gdtslam::test
