// A log read ahead by a thread of its own, so that whoever sends it never waits. At most so many scans wait; where one
// more comes the oldest waiting one is dropped whole, and its odometry stays: what a robot steers by should be new, and
// the way until then is known by the wheels. One caller.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class ScanQueue final : public LogReader {
 public:
  /// `stop` ends the wait of a caller; `close` makes the log end for the thread, which may be waiting for it.
  ScanQueue(std::unique_ptr<LogReader> log, std::size_t most_scans, std::function<bool()> stop,
            std::function<void()> close);
  ~ScanQueue() override;

  /// Records that were read before one that cannot be read come first.
  std::optional<LogRecord> next() override;
  [[nodiscard]] double progress() const override { return -1.0; }
  [[nodiscard]] const std::vector<Warning>& warnings() const override;

 private:
  void work();
  void take(LogRecord record);
  void drop_oldest_scan();

  std::unique_ptr<LogReader> log_;  // the thread's
  std::size_t most_scans_;
  std::function<bool()> stop_;
  std::function<void()> close_;
  mutable std::vector<Warning> given_warnings_;  // the caller's
  // Shared by both threads, under the lock:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<LogRecord> records_;
  std::size_t scans_ = 0;  // among them
  std::uint64_t dropped_ = 0;
  double first_dropped_s_ = 0.0;
  std::vector<Warning> warnings_;
  std::exception_ptr problem_;
  bool is_end_ = false;
  std::thread thread_;
};

}  // namespace gdtslam
