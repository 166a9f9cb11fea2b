// Writes lines to standard output by a thread of its own. Lines wait for a slow reader, and at the limit the writer
// waits too. After `patience` without progress the oldest lines are dropped whole, so a hanging reader never stops a
// robot's map. One writer.
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
    std::size_t most_waiting = 1024;        ///< lines, without the one being written
    std::chrono::milliseconds patience{0};  ///< with a reader that accepts nothing
  };
  explicit LineOutput(const Rule& rule, int descriptor = STDOUT_FILENO);
  LineOutput(const LineOutput&) = delete;
  LineOutput& operator=(const LineOutput&) = delete;
  /// Drops what still waits.
  ~LineOutput();

  /// The line ends in a newline, or is empty. A failed write does not stop the drive; finish() reports it.
  void write(std::string line);
  /// Waits while the reader keeps reading; drops the rest if it does not. Throws FileError if standard output could not
  /// be written; a reader that is gone is no error.
  void finish();
  /// Whether finish() will throw.
  [[nodiscard]] bool has_failed() const;
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  class Lines;

  std::shared_ptr<Lines> lines_;  // shared with the thread, which may outlive this
  std::thread thread_;
};

}  // namespace gdtslam
