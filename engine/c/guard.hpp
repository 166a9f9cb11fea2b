// What stands between the library and C: no exception crosses, and each becomes a status with its text.
#pragma once

#include <string>
#include <utility>

#include "gdtslam.h"
#include "gdtslam/core/error.hpp"

namespace gdtslam::c {

/// Says that all is well.
void clear(gdtslam_error* error) noexcept;
/// The status of the exception in hand, which is told to the caller.
gdtslam_status caught(gdtslam_error* error) noexcept;

/// Does the work; the status of what it throws.
template <class Work>
gdtslam_status guarded(gdtslam_error* error, Work&& work) noexcept {
  try {
    clear(error);
    std::forward<Work>(work)();
    return GDTSLAM_OK;
  } catch (...) {
    return caught(error);
  }
}

/// Throws UsageError where a pointer is NULL that must not be; `what` names it, "gdtslam_map_log: log".
void require(const void* pointer, const char* what);

/// The same for what a call gives back, which is NULL from then on until the call has something to give.
template <class Handle>
void require_result(Handle** result, const char* what) {
  require(static_cast<const void*>(result), what);
  *result = nullptr;
}

/// "" for NULL.
inline std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

}  // namespace gdtslam::c
