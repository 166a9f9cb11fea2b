// Observations of a stream that a thread reads and decodes ahead of the mapper. An exception of the stream is thrown in
// its place, after the scans before it. One caller.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scan_stream.hpp"

namespace gdtslam {

/// True if all logs are plain files that do not grow, so that reading never waits long.
bool are_plain_files(const std::vector<std::string>& logs);

class ScanAhead {
 public:
  /// `scans` must outlive this; leave it alone until stop(). Without a thread, next() reads them.
  ScanAhead(ScanStream& scans, bool has_thread);
  ScanAhead(const ScanAhead&) = delete;
  ScanAhead& operator=(const ScanAhead&) = delete;
  ~ScanAhead() { stop(); }

  /// Same as ScanStream::next_observation().
  std::optional<Observation> next();
  /// Value of ScanStream::progress() when the last observation given was read.
  [[nodiscard]] double progress() const { return has_thread_ ? progress_ : scans_.progress(); }
  /// Ends the thread; what was read ahead is dropped.
  void stop();
  /// CPU time of the thread; after stop().
  [[nodiscard]] double cpu_s() const { return cpu_s_; }

 private:
  /// An observation, none at the end, or an exception.
  struct Read {
    std::optional<Observation> observation;
    double progress = -1.0;
    std::exception_ptr problem;
  };
  static constexpr std::size_t kMostAhead = 128;

  void work();
  [[nodiscard]] Read read_one();

  ScanStream& scans_;
  bool has_thread_;
  double progress_ = -1.0;
  std::deque<Read> taken_;  // used by the caller alone
  // Shared by both, under the lock:
  std::mutex mutex_;
  std::condition_variable read_changed_;
  std::condition_variable room_;
  std::deque<Read> read_;
  bool is_stopped_ = false;
  double cpu_s_ = 0.0;
  std::thread thread_;
};

}  // namespace gdtslam
