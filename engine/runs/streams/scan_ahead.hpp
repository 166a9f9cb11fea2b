// The observations of a stream, read and decoded by a thread of their own some ahead of whoever maps them. What the
// stream throws comes in its place, behind the scans before it. One caller.
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

/// Whether all of these are files that do not grow while they are read: to wait for more of them never takes long.
bool are_plain_files(const std::vector<std::string>& logs);

class ScanAhead {
 public:
  /// `scans` must outlive this and is not to be touched until stop(). Without a thread they are read when they are
  /// asked for.
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
  /// That the thread spent; after stop().
  [[nodiscard]] double cpu_s() const { return cpu_s_; }

 private:
  /// An observation, or none at the end, or what was thrown.
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
  std::deque<Read> taken_;  // the caller's
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
