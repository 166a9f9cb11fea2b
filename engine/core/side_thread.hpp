// A thread that runs one caller's tasks in order while the caller continues. An exception of a task is rethrown to the
// caller, and later tasks do not start. One caller. Cost: one lock for each task; the thread is woken once for many
// tasks.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace gdtslam {

/// CPU seconds that the calling thread has spent so far.
double own_cpu_s();

class SideThread {
 public:
  using Task = std::function<void()>;

  /// At most `most_waiting` tasks wait. Without a thread, or if the system has none, give() runs each task itself.
  SideThread(bool has_thread, std::size_t most_waiting);
  SideThread(const SideThread&) = delete;
  SideThread& operator=(const SideThread&) = delete;
  /// Drops tasks that have not started.
  ~SideThread();

  /// Waits while the queue is full. Rethrows an exception of an earlier task.
  void give(Task task);
  /// Waits until all tasks are done and ends the thread; rethrows an exception of a task.
  void finish();
  /// CPU time of the thread once it has ended; 0 before, and without a thread.
  [[nodiscard]] double cpu_s() const { return cpu_s_; }

 private:
  void work();
  void end(bool at_once);

  bool has_thread_;
  std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable wake_;  // the thread
  std::condition_variable room_;  // the caller
  std::deque<Task> waiting_;
  std::exception_ptr failure_;
  bool is_ending_ = false;
  double cpu_s_ = 0.0;
  std::thread thread_;
};

}  // namespace gdtslam
