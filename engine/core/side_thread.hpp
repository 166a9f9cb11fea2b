// A thread that carries out one caller's tasks in the order in which they were given, while the caller goes on. What a
// task throws is rethrown to the caller, and no task after it is begun. One caller. Cost: a lock a task; the thread is
// woken once for many of them.
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

  /// At most so many tasks wait. Without a thread, or where the system has none to give, the caller's own carries each
  /// task out when it is given.
  SideThread(bool has_thread, std::size_t most_waiting);
  SideThread(const SideThread&) = delete;
  SideThread& operator=(const SideThread&) = delete;
  /// Drops the tasks that are not begun.
  ~SideThread();

  /// Waits while as many wait as may. Rethrows what a task threw before.
  void give(Task task);
  /// Waits until all that was given is done; rethrows what a task threw. The thread has ended then.
  void finish();
  /// That the thread spent, from its beginning to its end; 0 before, and where there was none.
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
