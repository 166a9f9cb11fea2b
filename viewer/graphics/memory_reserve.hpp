// Memory that is kept for VTK: where an allocation of the standard library of C++ fails inside of it, it follows the
// null that it made of what it could not have (its shaders are texts of streams that do not grow). While a reserve
// lives, such an allocation is given what was kept, VTK goes on, and the caller is told afterwards.
#pragma once

#include <cstdint>

namespace gdtslam {

class MemoryReserve {
 public:
  /// Keeps memory that is not touched: some microseconds. Reserves of several threads share one. Throws std::bad_alloc.
  MemoryReserve();
  /// Where no reserve is left, allocations fail again as before.
  ~MemoryReserve();
  MemoryReserve(const MemoryReserve&) = delete;
  MemoryReserve& operator=(const MemoryReserve&) = delete;

  /// Throws std::bad_alloc where an allocation of any thread has failed since the constructor.
  void throw_where_memory_ended() const;

 private:
  std::uint64_t ends_before_;
};

}  // namespace gdtslam
