#include "thread_pool.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

/// Slices a thread, so that one that is held up leaves its share to others.
constexpr std::uint64_t kSlicesPerThread = 4;

}  // namespace

ThreadPool::ThreadPool(unsigned threads) {
  for (unsigned i = 1; i < threads; ++i) {
    workers_.emplace_back([this] { work(); });
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

void ThreadPool::run(CpuFunction function, const CpuLaunch& launch, std::uint32_t count, std::uint32_t grain) {
  Job job{function, launch, count, count};
  const std::uint64_t parts = threads() * kSlicesPerThread;
  job.slice = std::max<std::uint64_t>((count + parts - 1) / parts, 1);
  job.slice = (job.slice + grain - 1) / grain * grain;
  {
    const std::lock_guard lock(mutex_);
    job_ = job;
    next_.store(0, std::memory_order_relaxed);
    busy_ = static_cast<unsigned>(workers_.size());
    ++generation_;
  }
  wake_.notify_all();
  take_slices(job);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
}

void ThreadPool::work() {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return stop_ || generation_ != seen; });
    if (stop_) {
      return;
    }
    seen = generation_;
    const Job job = job_;
    lock.unlock();
    take_slices(job);
    lock.lock();
    if (--busy_ == 0) {
      done_.notify_one();
    }
  }
}

void ThreadPool::take_slices(const Job& job) {
  CpuLaunch launch = job.launch;
  while (true) {
    const std::uint64_t begin = next_.fetch_add(job.slice, std::memory_order_relaxed);
    if (begin >= job.count) {
      return;
    }
    launch.begin = static_cast<std::uint32_t>(begin);
    launch.end = static_cast<std::uint32_t>(std::min(begin + job.slice, job.count));
    job.function(launch);
  }
}

}  // namespace gdtslam
