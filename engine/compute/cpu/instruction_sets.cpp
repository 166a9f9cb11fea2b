// Available instruction sets, and the count of the calls of their kernels.
#include <deque>
#include <mutex>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "launch.hpp"

namespace gdtslam {

bool isa_available(Isa isa) {
  if (!is_compiled(isa)) {
    return false;
  }
#ifdef GDTSLAM_X86_KERNELS
  if (isa == Isa::kAvx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
  }
  if (isa == Isa::kAvx512) {
    return isa_available(Isa::kAvx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512cd");
  }
#endif
  return true;
}

Isa best_isa() {
  static const Isa best = [] {
    if (isa_available(Isa::kAvx512)) {
      return Isa::kAvx512;
    }
    return isa_available(Isa::kAvx2) ? Isa::kAvx2 : Isa::kBaseline;
  }();
  return best;
}

constinit thread_local std::atomic<std::uint64_t>* calls_of_this_thread = nullptr;

namespace {

/// All words. Those of ended threads keep their counts and serve the next thread.
struct Words {
  std::mutex mutex;
  std::deque<std::atomic<std::uint64_t>> all;  // never moves an element
  std::vector<std::atomic<std::uint64_t>*> unused;
};

Words& words() {
  static Words& shared = *new Words;  // never destroyed: threads may end after static objects are destroyed
  return shared;
}

/// Returns the word when the thread ends.
struct Membership {
  Membership() = default;
  Membership(const Membership&) = delete;
  Membership& operator=(const Membership&) = delete;
  ~Membership() {
    const std::lock_guard lock(words().mutex);
    words().unused.push_back(calls_of_this_thread);
    calls_of_this_thread = nullptr;
  }
};

}  // namespace

std::atomic<std::uint64_t>& enlist_this_thread() {
  const std::lock_guard lock(words().mutex);
  if (words().unused.empty()) {
    words().unused.push_back(&words().all.emplace_back(0));
  }
  calls_of_this_thread = words().unused.back();
  words().unused.pop_back();
  thread_local const Membership membership;
  return *calls_of_this_thread;
}

std::uint64_t cpu_kernel_calls() {
  const std::lock_guard lock(words().mutex);
  std::uint64_t sum = 0;
  for (const std::atomic<std::uint64_t>& word : words().all) {
    sum += word.load(std::memory_order_relaxed);
  }
  return sum;
}

}  // namespace gdtslam
