// Lines on standard output for whoever steers by them, written at once while the reader takes them. Where it is slow
// they wait, and the writer waits for it; where it takes none at all for that long, or nobody may wait, the oldest
// lines are dropped whole, so that a reader that hangs never stops a robot's map. One writer; a thread of its own
// writes what had to wait.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

namespace gdtslam {

class LineOutput {
 public:
  struct Rule {
    std::size_t most_waiting = 1024;        ///< lines
    std::chrono::milliseconds patience{0};  ///< with a reader that takes none
  };
  explicit LineOutput(const Rule& rule) : rule_(rule) {}
  LineOutput(const LineOutput&) = delete;
  LineOutput& operator=(const LineOutput&) = delete;
  /// What still waits is dropped.
  ~LineOutput();

  /// Ends in a newline. Where it cannot be written the drive goes on; finish() tells.
  void write(std::string line);
  /// Waits for a reader that goes on reading; what one leaves that does not is dropped. Throws FileError where standard
  /// output could not be written; a reader that is gone is no error.
  void finish();
  /// Whether it will throw.
  [[nodiscard]] bool has_failed();
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  void work();
  bool write_some();
  void drop_oldest();
  void note_progress();
  void end();

  Rule rule_;
  std::mutex mutex_;
  std::condition_variable wake_;  // the thread
  std::condition_variable room_;  // the writer
  std::deque<std::string> waiting_;
  std::size_t written_ = 0;     // bytes of the first of them
  std::uint64_t progress_ = 0;  // lines
  std::uint64_t dropped_ = 0;
  bool is_stuck_ = false;  // the reader, since patience with it ended
  bool is_gone_ = false;
  bool is_ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace gdtslam
