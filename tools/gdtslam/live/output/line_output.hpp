// Lines on standard output for whoever steers by them, written by a thread of its own. If the reader is slow they wait,
// and the writer waits for it; if it takes none at all for that long, or nobody may wait, the oldest lines are dropped
// whole, so that a reader that hangs never stops a robot's map. One writer.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

namespace gdtslam {

class LineOutput {
 public:
  struct Rule {
    std::size_t most_waiting = 1024;        ///< lines, beside the one that is being written
    std::chrono::milliseconds patience{0};  ///< with a reader that takes none
  };
  explicit LineOutput(const Rule& rule, int descriptor = STDOUT_FILENO);
  LineOutput(const LineOutput&) = delete;
  LineOutput& operator=(const LineOutput&) = delete;
  /// Drops what still waits.
  ~LineOutput();

  /// The line ends in a newline, or is empty. If it cannot be written the drive goes on; finish() tells.
  void write(std::string line);
  /// Waits for a reader that goes on reading; what another one leaves is dropped. Throws FileError if standard output
  /// could not be written; a reader that is gone is no error.
  void finish();
  /// Whether finish() will throw.
  [[nodiscard]] bool has_failed() const;
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  class Lines;

  std::shared_ptr<Lines> lines_;  // also the thread's, which is left behind if nobody takes what it writes
  std::thread thread_;
};

}  // namespace gdtslam
