// Lines on standard output for whoever steers by them, or on standard error, written at once while the reader takes
// them. Where it is slow they wait, and the writer waits for it; where it takes none at all for that long, or nobody
// may wait, the oldest lines are dropped whole, so that a reader that hangs never stops a robot's map. One writer; a
// thread of its own writes what had to wait, and all that goes to a terminal, which may make whoever writes to it wait
// without end.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

namespace gdtslam {

/// With a reader that may be slow, but not hang.
inline constexpr std::chrono::seconds kReaderPatience{5};

class LineOutput {
 public:
  struct Rule {
    std::size_t most_waiting = 1024;        ///< lines, beside the one that is being written
    std::chrono::milliseconds patience{0};  ///< with a reader that takes none
    bool tries_each = false;                ///< after a line that cannot be written, as on a full disk
  };
  explicit LineOutput(const Rule& rule, int descriptor = STDOUT_FILENO);
  LineOutput(const LineOutput&) = delete;
  LineOutput& operator=(const LineOutput&) = delete;
  /// What still waits is dropped.
  ~LineOutput();

  /// The thread, which else begins where a line has to wait. Throws std::system_error.
  void start();
  /// Ends in a newline, or is empty. Where it cannot be written the drive goes on; finish() tells.
  void write(std::string line);
  /// Waits for a reader that goes on reading; what one leaves that does not is dropped. Throws FileError where standard
  /// output could not be written; a reader that is gone is no error.
  void finish();
  /// Whether it will throw.
  [[nodiscard]] bool has_failed() const;
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  class Lines;
  void end();

  std::shared_ptr<Lines> lines_;  // also the thread's, which is left behind where nobody takes what it writes
  std::thread thread_;
};

}  // namespace gdtslam
