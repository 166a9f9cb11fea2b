// A persistent pool that splits a range of indices. Which thread takes which slice depends on the load; what a slice
// computes does not, so results are independent of the number of threads. One caller at a time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

class ThreadPool {
 public:
  /// `threads` in all, the caller included.
  explicit ThreadPool(unsigned threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool();

  /// Calls function(launch) on disjoint slices of [0, count), each but the last a multiple of `grain`; waits for all.
  void run(CpuFunction function, const CpuLaunch& launch, std::uint32_t count, std::uint32_t grain);

  [[nodiscard]] unsigned threads() const { return static_cast<unsigned>(workers_.size()) + 1; }

 private:
  struct Job {
    CpuFunction function = nullptr;
    CpuLaunch launch;
    std::uint64_t count = 0;
    std::uint64_t slice = 1;
  };
  void work();
  void take_slices(const Job& job);

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  Job job_;
  std::uint64_t generation_ = 0;  ///< counts jobs; a worker takes part in each once
  unsigned busy_ = 0;             ///< workers that have not finished the current job
  bool stop_ = false;
  std::atomic<std::uint64_t> next_{0};
  std::vector<std::thread> workers_;
};

}  // namespace gdtslam
