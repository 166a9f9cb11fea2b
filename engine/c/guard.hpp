// The border between the library and C: each exception becomes a status with its text, and structs may come from
// programs compiled with another gdtslam.h.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include "gdtslam.h"
#include "gdtslam/core/error.hpp"

namespace gdtslam::c {

/// Sets the status to success.
void clear(gdtslam_error* error) noexcept;
/// Reports the current exception to the caller and returns its status.
gdtslam_status caught(gdtslam_error* error) noexcept;

/// Does the work; returns the status of its exception, if any.
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

/// Throws UsageError if the pointer is NULL; `what` names it, "gdtslam_map_log: log".
void require(const void* pointer, const char* what);

/// The same for a result of a call, which is set to NULL until the call has one.
template <class Handle>
void require_result(Handle** result, const char* what) {
  require(static_cast<const void*>(result), what);
  *result = nullptr;
}

/// "" for NULL.
inline std::string to_text(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// Reads a caller's request, whose struct may be of an older or a newer gdtslam.h: it states its size. Members that an
/// older program lacks are 0. Additional members of a newer one must be 0, because they would be ignored silently.
/// `least` is the size in the first version. Throws UsageError.
template <class Struct>
Struct read_struct(const Struct* given, std::size_t least, const char* what) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  if (given == nullptr) throw UsageError(std::string(what) + " is NULL");
  const std::size_t size = given->size;
  if (size < least) {
    throw UsageError(std::string(what) + ": its size is " + std::to_string(size) + " and not " +
                     std::to_string(sizeof(Struct)) + ": begin with GDTSLAM_INIT");
  }
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  if (size > sizeof(Struct) && std::any_of(bytes + sizeof(Struct), bytes + size, [](auto byte) { return byte != 0; })) {
    throw UsageError(std::string(what) + ": asks for what this version of the library does not know, " GDTSLAM_VERSION);
  }
  Struct known{};
  std::memcpy(&known, given, std::min(size, sizeof(Struct)));
  known.size = sizeof(Struct);
  return known;
}

/// Throws UsageError if write_struct() would.
template <class Struct>
void require_writable(const Struct* target, const char* what) {
  if (target == nullptr) throw UsageError(std::string(what) + " is NULL");
  if (target->size <= sizeof(target->size)) {
    throw UsageError(std::string(what) + ": its size is " + std::to_string(target->size) + " and not " +
                     std::to_string(sizeof(Struct)) + ": begin with GDTSLAM_INIT");
  }
}

/// Fills in the members of the caller's version; additional ones become 0. Throws UsageError like read_struct().
template <class Struct>
void write_struct(Struct value, Struct* target, const char* what) {
  static_assert(std::is_trivially_copyable_v<Struct>);
  require_writable(target, what);
  const std::size_t size = target->size;
  value.size = size;
  auto* const bytes = reinterpret_cast<unsigned char*>(target);
  if (size > sizeof(Struct)) std::fill(bytes + sizeof(Struct), bytes + size, static_cast<unsigned char>(0));
  std::memcpy(target, &value, std::min(size, sizeof(Struct)));
}

/// The size of a struct up to and including one of its members.
#define GDTSLAM_SIZE_WITH(type, member) (offsetof(type, member) + sizeof(type::member))

}  // namespace gdtslam::c
