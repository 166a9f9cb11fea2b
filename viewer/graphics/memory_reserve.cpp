#include "memory_reserve.hpp"

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <new>

namespace gdtslam {
namespace {

// VTK's texts of a frame are some 100 kB.
constexpr std::size_t kReservedBytes = std::size_t{4} << 20U;

std::mutex reserve_lock;
int reserves_alive = 0;
std::new_handler handler_before = nullptr;
std::atomic<void*> reserved = nullptr;
std::atomic<std::uint64_t> ends_of_memory = 0;

// Called by operator new, which asks again where this returns.
void lend_reserve() {
  ends_of_memory.fetch_add(1);
  void* const memory = reserved.exchange(nullptr);
  if (memory == nullptr) throw std::bad_alloc();
  std::free(memory);
}

}  // namespace

MemoryReserve::MemoryReserve() : ends_before_(ends_of_memory.load()) {
  const std::scoped_lock lock(reserve_lock);
  if (reserved.load() == nullptr) {
    void* const memory = std::malloc(kReservedBytes);
    if (memory == nullptr) throw std::bad_alloc();
    reserved.store(memory);
  }
  if (reserves_alive++ == 0) handler_before = std::set_new_handler(lend_reserve);
}

MemoryReserve::~MemoryReserve() {
  const std::scoped_lock lock(reserve_lock);
  if (--reserves_alive > 0) return;
  std::set_new_handler(handler_before);
  std::free(reserved.exchange(nullptr));
}

void MemoryReserve::throw_where_memory_ended() const {
  if (ends_of_memory.load() != ends_before_) throw std::bad_alloc();
}

}  // namespace gdtslam
