// Source of a drive's lines: standard input or a named pipe, a file that grows, a socket. Each wait is short, so a
// signal that reaches another thread ends it too. One thread reads an input; close() and the counts are thread-safe.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

class LiveInput {
 public:
  explicit LiveInput(std::string name) : name_(std::move(name)) {}
  LiveInput(const LiveInput&) = delete;
  LiveInput& operator=(const LiveInput&) = delete;
  virtual ~LiveInput() = default;

  /// Fills at most the target; waits if there is nothing yet. Returns 0 at the end: end of the pipe, a signal, close().
  /// Throws FileError.
  virtual std::size_t read(std::span<char> target) = 0;
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t half_lines() const { return half_lines_; }
  void close() { is_closed_ = true; }

 protected:
  /// Whether a signal came or the input was closed.
  [[nodiscard]] bool is_over() const;
  /// Waits for at most `most_ms` until the descriptor can be read; false if it cannot yet.
  static bool wait_for(int descriptor, int most_ms = 100);
  void count_half_line() { ++half_lines_; }

 private:
  std::string name_;
  std::atomic<bool> is_closed_ = false;
  std::atomic<std::uint64_t> half_lines_ = 0;
};

/// Standard input ("-"), a pipe or a file, from its beginning to its end; bytes are not changed. Throws FileError.
std::unique_ptr<LiveInput> open_stream(const std::string& path);

/// Whole lines of a file that others write to, from its beginning. If another file takes its name, or it is cut,
/// reading starts again at the beginning, with a remark. Only a signal ends it. Throws FileError.
std::unique_ptr<LiveInput> follow_file(const std::string& path);

/// Whole lines from a socket that serves one sender at a time. The next one gets its turn when the current sender is
/// gone, or has sent nothing for some seconds while another one waits. Only a signal ends it. `address` is unix:PATH,
/// tcp:PORT or tcp:ADDRESS:PORT. Throws UsageError for any other address, FileError if the system refuses.
std::unique_ptr<LiveInput> listen_at(const std::string& address);

/// Opens the log of that input; call it once. With `queue` scans a thread reads ahead; if more are waiting, the oldest
/// scan is dropped but not its odometry. The log's warnings report what was dropped or lost. With 0 nothing is read
/// ahead, and the sender waits.
LiveLog make_live_log(std::shared_ptr<LiveInput> input, std::size_t queue);

}  // namespace gdtslam
