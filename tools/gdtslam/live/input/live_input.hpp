// Where the lines of a drive come from while it lasts: standard input or a named pipe, a file that grows, a socket.
// They are waited for in short slices, so that a signal that came to another thread ends the wait too. One input is
// read by one thread; close() and the counts are anybody's.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class LiveInput {
 public:
  LiveInput() = default;
  LiveInput(const LiveInput&) = delete;
  LiveInput& operator=(const LiveInput&) = delete;
  virtual ~LiveInput() = default;

  /// Fills at most the target, and waits where there is nothing yet; 0 at the end: that of a pipe, a signal, close().
  /// Throws FileError, InputError.
  virtual std::size_t read(std::span<char> target) = 0;
  /// As it stands in messages.
  [[nodiscard]] virtual std::string name() const = 0;
  /// What was lost on the way, counted by kind.
  [[nodiscard]] std::vector<LogReader::Warning> warnings() const;
  void close() { is_closed_ = true; }

 protected:
  /// A signal came, or nobody reads any more.
  [[nodiscard]] bool is_over() const;
  /// Waits, not longer than a tenth of a second, until the descriptor can be read; false where it cannot yet.
  static bool wait_for(int descriptor);
  void count_half_line() { ++half_lines_; }

 private:
  std::atomic<bool> is_closed_ = false;
  std::atomic<std::uint64_t> half_lines_ = 0;
};

/// Standard input ("-"), a pipe or a file, from its beginning to its end; bytes as they are. Throws FileError.
std::unique_ptr<LiveInput> open_stream(const std::string& path);

/// A file that others write to, from its beginning on, whole lines. It ends with a signal only. Throws FileError;
/// reading throws InputError where it has become shorter.
std::unique_ptr<LiveInput> follow_file(const std::string& path);

/// A socket to which one sender at a time connects, whole lines. When a sender is gone the next one goes on; it ends
/// with a signal only. `address` is unix:PATH, tcp:PORT or tcp:ADDRESS:PORT. Throws UsageError where it is none,
/// FileError where the system does not allow it.
std::unique_ptr<LiveInput> listen_at(const std::string& address);

}  // namespace gdtslam
