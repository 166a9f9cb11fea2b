// Whether the process was asked to end, as by a signal: calls that wait for somebody are not made again then.
#pragma once

#include <atomic>

namespace gdtslam {

/// Nobody asks unless the program says how that is told. To be set before there are threads.
inline std::atomic<bool (*)()> asked_to_end = nullptr;

inline bool is_asked_to_end() {
  bool (*const asked)() = asked_to_end;
  return asked != nullptr && asked();
}

}  // namespace gdtslam
