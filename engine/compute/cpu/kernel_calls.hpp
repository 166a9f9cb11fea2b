// The count of calls of CPU kernels, by which `verify` proves that a device used none of them. Each thread counts for
// itself, in a word that only it writes: a call costs a load and a store, without a locked instruction.
#pragma once

#include <atomic>
#include <cstdint>

namespace gdtslam {

/// This thread's word; null before its first call.
extern constinit thread_local std::atomic<std::uint64_t>* calls_of_this_thread;

/// Gives this thread a word.
std::atomic<std::uint64_t>& enlist_this_thread();

inline void count_kernel_call() {
  std::atomic<std::uint64_t>& calls = calls_of_this_thread != nullptr ? *calls_of_this_thread : enlist_this_thread();
  calls.store(calls.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

}  // namespace gdtslam
