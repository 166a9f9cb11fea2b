// The border between the library and C: no exception crosses it, each becomes a status with its text, and structs may
// be of programs that were compiled with another gdtslam.h.
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
inline std::string to_text(const char* text) { return text == nullptr ? std::string() : std::string(text); }

/// The request of a caller, whose struct may be of an older or a newer gdtslam.h: it states its size. Members that an
/// older program does not have are 0; what a newer one has beyond ours must be 0, for it would be left out in silence.
/// `least` is the size of what every version has. Throws UsageError.
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

/// Throws UsageError as read_struct() where write_struct() would.
template <class Struct>
void require_writable(const Struct* target, const char* what) {
  if (target == nullptr) throw UsageError(std::string(what) + " is NULL");
  if (target->size <= sizeof(target->size)) {
    throw UsageError(std::string(what) + ": its size is " + std::to_string(target->size) + " and not " +
                     std::to_string(sizeof(Struct)) + ": begin with GDTSLAM_INIT");
  }
}

/// Fills in the members that the caller's version has; what it has beyond ours becomes 0. Throws UsageError as
/// read_struct().
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

/// The size of a struct up to and with one of its members.
#define GDTSLAM_SIZE_WITH(type, member) (offsetof(type, member) + sizeof(type::member))

}  // namespace gdtslam::c
