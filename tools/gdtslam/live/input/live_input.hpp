// Source of a drive's lines while it lasts: standard input or a named pipe, a file that grows, a socket. Each wait is
// short, so that a signal that came to another thread ends it too. One input is read by one thread; close() and the
// counts may be used by any.
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

  /// Fills at most the target, and waits if there is nothing yet; 0 at the end: that of a pipe, a signal, close().
  /// Throws FileError.
  virtual std::size_t read(std::span<char> target) = 0;
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t half_lines() const { return half_lines_; }
  void close() { is_closed_ = true; }

 protected:
  /// A signal came, or nobody reads any more.
  [[nodiscard]] bool is_over() const;
  /// Waits, not longer than a tenth of a second, until the descriptor can be read; false if it cannot yet.
  static bool wait_for(int descriptor, int most_ms = 100);
  void count_half_line() { ++half_lines_; }

 private:
  std::string name_;
  std::atomic<bool> is_closed_ = false;
  std::atomic<std::uint64_t> half_lines_ = 0;
};

/// Standard input ("-"), a pipe or a file, from its beginning to its end; bytes as they are. Throws FileError.
std::unique_ptr<LiveInput> open_stream(const std::string& path);

/// A file that others write to, from its beginning on, whole lines. A file that takes its name, or its own beginning
/// after it was cut, is read on, with a remark. It ends with a signal only. Throws FileError.
std::unique_ptr<LiveInput> follow_file(const std::string& path);

/// A socket to which one sender at a time connects, whole lines. When a sender is gone, or has sent nothing for some
/// seconds while another one waits, the next one goes on; it ends with a signal only. `address` is unix:PATH, tcp:PORT
/// or tcp:ADDRESS:PORT. Throws UsageError for another one, FileError if the system does not allow it.
std::unique_ptr<LiveInput> listen_at(const std::string& address);

/// Opens the log of that input, once. With `queue` scans a thread reads ahead, and if more are waiting the oldest of
/// them is dropped, not its odometry; what was dropped or lost is among the log's warnings. With 0 nothing is read
/// before it is asked for, and the sender waits.
LiveLog make_live_log(std::shared_ptr<LiveInput> input, std::size_t queue);

}  // namespace gdtslam
