#include "worker_pool.hpp"

#include <algorithm>
#include <new>
#include <system_error>
#include <utility>

#include "signals_blocked.hpp"

namespace gdtslam {
namespace {

/// Slices for each thread, so that others take over the share of a delayed one.
constexpr std::uint64_t kSlicesPerThread = 4;
constexpr unsigned kMostThreads = 1024;

}  // namespace

unsigned threads_meant(unsigned asked) {
  return std::clamp(asked == 0 ? std::thread::hardware_concurrency() : asked, 1U, kMostThreads);
}

WorkerPool::WorkerPool(unsigned threads) {
  const SignalsBlocked blocked;
  workers_.reserve(threads);
  try {
    while (workers_.size() + 1 < threads) workers_.emplace_back([this] { work(); });
  } catch (const std::system_error&) {  // the workers started so far do the work
    return;
  } catch (const std::bad_alloc&) {
    return;
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void WorkerPool::run(std::uint64_t count, std::uint64_t grain, const Body& body) {
  if (count == 0) return;
  if (workers_.empty() || count <= grain) {
    body(0, count);
    return;
  }
  Job job{.body = &body, .count = count};
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
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void WorkerPool::work() {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return stop_ || generation_ != seen; });
    if (stop_) return;
    seen = generation_;
    const Job job = job_;
    lock.unlock();
    take_slices(job);
    lock.lock();
    if (--busy_ == 0) done_.notify_one();
  }
}

void WorkerPool::take_slices(const Job& job) {
  try {
    while (true) {
      const std::uint64_t begin = next_.fetch_add(job.slice, std::memory_order_relaxed);
      if (begin >= job.count) return;
      (*job.body)(begin, std::min(begin + job.slice, job.count));
    }
  } catch (...) {
    next_.store(job.count, std::memory_order_relaxed);
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
  }
}

}  // namespace gdtslam
