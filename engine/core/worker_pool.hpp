// A persistent pool of threads that share a range of indices. The load decides which thread takes which slice. The
// result of a slice must not depend on that; then results do not depend on the number of threads. One caller at a time.
// Cost: some microseconds for a range to wake the threads; none with only the caller's thread.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace gdtslam {

class WorkerPool {
 public:
  /// `threads` in all, including the caller's; fewer if the system has no more.
  explicit WorkerPool(unsigned threads);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  ~WorkerPool();

  /// The work on indices from begin to end, the end not included.
  using Body = std::function<void(std::uint64_t begin, std::uint64_t end)>;
  /// Calls body on disjoint slices of [0, count), each but the last a multiple of `grain`, and waits for all. Rethrows
  /// one exception of the slices; slices not yet started are then left out.
  void run(std::uint64_t count, std::uint64_t grain, const Body& body);

  [[nodiscard]] unsigned threads() const { return static_cast<unsigned>(workers_.size()) + 1; }

 private:
  struct Job {
    const Body* body = nullptr;
    std::uint64_t count = 0;
    std::uint64_t slice = 1;
  };
  void work();
  void take_slices(const Job& job);

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  Job job_;
  std::exception_ptr failure_;
  std::uint64_t generation_ = 0;  ///< counts jobs; a worker takes part in each once
  unsigned busy_ = 0;             ///< workers that have not finished the current job
  bool stop_ = false;
  std::atomic<std::uint64_t> next_{0};
  std::vector<std::thread> workers_;
};

/// The requested number, or the number of processors if it is 0.
unsigned threads_meant(unsigned asked);

}  // namespace gdtslam
