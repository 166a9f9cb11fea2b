#include "side_thread.hpp"

#include <ctime>
#include <new>
#include <system_error>
#include <utility>

#include "scheduling.hpp"
#include "signals_blocked.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kWokenFor = 8;  // wakes at this part of a full queue: waking costs as much as a small task

}  // namespace

double own_cpu_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1.0e-9 * static_cast<double>(time.tv_nsec);
}

SideThread::SideThread(bool has_thread, std::size_t most_waiting)
    : has_thread_(has_thread), most_waiting_(most_waiting) {
  if (!has_thread_) return;
  const SignalsBlocked blocked;
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error&) {
    has_thread_ = false;
  } catch (const std::bad_alloc&) {
    has_thread_ = false;
  }
}

SideThread::~SideThread() { end(true); }

void SideThread::give(Task task) {
  if (!has_thread_) {
    if (failure_) std::rethrow_exception(failure_);
    try {
      task();
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
    return;
  }
  std::unique_lock lock(mutex_);
  if (waiting_.size() >= most_waiting_) {
    room_.wait(lock, [this] { return failure_ || waiting_.size() <= most_waiting_ / 2; });
  }
  if (failure_) std::rethrow_exception(failure_);
  waiting_.push_back(std::move(task));
  if (waiting_.size() == 1 + most_waiting_ / kWokenFor) wake_.notify_one();
}

void SideThread::finish() {
  end(false);
  if (failure_) std::rethrow_exception(failure_);
}

void SideThread::end(bool at_once) {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
    if (at_once) waiting_.clear();
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void SideThread::work() {
  run_in_background();
  std::unique_lock lock(mutex_);
  while (!failure_) {
    wake_.wait(lock, [this] { return is_ending_ || waiting_.size() > most_waiting_ / kWokenFor; });
    if (waiting_.empty()) break;
    while (!waiting_.empty() && !failure_) {
      Task task = std::move(waiting_.front());
      waiting_.pop_front();
      if (waiting_.size() == most_waiting_ / 2) room_.notify_one();
      lock.unlock();
      std::exception_ptr failure;
      try {
        task();
      } catch (...) {
        failure = std::current_exception();
      }
      task = {};
      lock.lock();
      failure_ = failure;
    }
  }
  cpu_s_ = own_cpu_s();
  room_.notify_one();
}

}  // namespace gdtslam
