// A log that its own thread reads ahead, so the sender never waits. The number of waiting scans is limited: one more
// drops the oldest waiting scan but not its odometry. A robot steers by new scans, and the wheels measure the way until
// then. One caller.
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
  /// `stop` ends a caller's wait; `close` ends the log for the thread, which may be waiting for it.
  ScanQueue(std::unique_ptr<LogReader> log, std::size_t most_scans, std::function<bool()> stop,
            std::function<void()> close);
  ~ScanQueue() override;

  /// Returns all records read before an error, then throws the error.
  std::optional<LogRecord> next() override;
  [[nodiscard]] double progress() const override { return -1.0; }
  [[nodiscard]] const std::vector<Warning>& warnings() const override;

 private:
  void work();
  void take(LogRecord record);
  void drop_oldest_scan();

  std::unique_ptr<LogReader> log_;  // used by the thread
  std::size_t most_scans_;
  std::function<bool()> stop_;
  std::function<void()> close_;
  mutable std::vector<Warning> given_warnings_;  // used by the caller
  // Shared by both threads, under the lock:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<LogRecord> records_;
  std::size_t scans_ = 0;  // scans among the records
  std::uint64_t dropped_ = 0;
  double first_dropped_s_ = 0.0;
  std::vector<Warning> warnings_;
  std::exception_ptr problem_;
  bool is_end_ = false;
  std::thread thread_;
};

}  // namespace gdtslam
