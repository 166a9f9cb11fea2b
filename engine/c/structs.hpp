// Structs of programs that were compiled with an older or a newer gdtslam.h: each tells its size.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>

#include "gdtslam/core/error.hpp"

namespace gdtslam::c {

/// What a caller asks for. Members that an older program does not have are 0; what a newer one has beyond ours must be
/// 0, for it would be left out in silence. `least` is the size of what every version has. Throws UsageError.
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

/// Fills in what the caller's version has; what it has beyond ours becomes 0. Throws UsageError as read_struct().
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
