#include "line_output.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::chrono::milliseconds kOutputSlice{100};  // after which the thread looks whether it is to end
constexpr std::chrono::milliseconds kHandover{10};      // in which it has written a line, where nothing holds it up

/// A pipe that can be written takes PIPE_BUF bytes without making anybody wait, and a socket is told not to.
ssize_t write_part(int descriptor, const char* bytes, std::size_t count) {
  const ssize_t sent = ::send(descriptor, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent < 0 && errno == ENOTSOCK ? ::write(descriptor, bytes, count) : sent;
}

}  // namespace

/// What the writer and the thread share.
class LineOutput::Lines {
 public:
  Lines(const Rule& rule, int descriptor)
      : rule_(rule), descriptor_(descriptor), is_terminal_(::isatty(descriptor) == 1) {}

  /// Whether the thread has something to write.
  bool add(std::string line);
  /// Until a terminal has the line, where no other was there before it.
  void wait_for_thread();
  /// What the thread does.
  void work();
  /// Drops what a reader leaves that does not go on.
  void wait_for_reader();
  /// Whether the thread ends now; else it waits for a terminal, for nobody knows how long.
  bool end();
  [[nodiscard]] std::exception_ptr failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }
  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  [[nodiscard]] bool has_lines() const { return !line_.empty() || !waiting_.empty(); }
  [[nodiscard]] bool can_write() const { return !is_writing_ && !is_ending_ && has_lines(); }
  [[nodiscard]] bool is_writable(std::chrono::milliseconds wait) const;
  void make_room(std::unique_lock<std::mutex>& lock);
  bool write_some(std::unique_lock<std::mutex>& lock);
  void stop(int error);

  Rule rule_;
  int descriptor_;
  bool is_terminal_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;  // the thread
  std::condition_variable room_;  // the writer
  std::deque<std::string> waiting_;
  std::string line_;            // of which a part is out, or on its way
  std::size_t written_ = 0;     // bytes of it
  std::uint64_t progress_ = 0;  // lines
  std::uint64_t dropped_ = 0;
  bool is_writing_ = false;
  bool is_cut_ = false;    // the line before ends in the middle, for want of room
  bool is_stuck_ = false;  // the reader, since patience with it ended
  bool is_gone_ = false;
  bool is_ending_ = false;
  std::exception_ptr failure_;
};

bool LineOutput::Lines::is_writable(std::chrono::milliseconds wait) const {
  pollfd output{.fd = descriptor_, .events = POLLOUT, .revents = 0};
  return ::poll(&output, 1, static_cast<int>(wait.count())) > 0;
}

// Without the lock, which the writer needs: a terminal that can be written may yet have room for less than this, and
// then waits for its reader. False where nothing went out.
bool LineOutput::Lines::write_some(std::unique_lock<std::mutex>& lock) {
  if (line_.empty()) {
    line_ = std::move(waiting_.front());
    waiting_.pop_front();
    if (is_cut_) line_.insert(0, "\n");
  }
  is_writing_ = true;
  lock.unlock();
  const std::size_t count = std::min<std::size_t>(line_.size() - written_, PIPE_BUF);
  const ssize_t done = write_part(descriptor_, line_.data() + written_, count);
  const int error = errno;
  lock.lock();
  is_writing_ = false;
  if (done < 0) {
    stop(error);
    return false;
  }
  written_ += static_cast<std::size_t>(done);
  if (written_ < line_.size()) return true;
  line_.clear();
  written_ = 0;
  is_cut_ = false;
  ++progress_;
  is_stuck_ = false;
  return true;
}

void LineOutput::Lines::stop(int error) {
  if (error == EINTR || error == EAGAIN) return;
  // The reader had enough, as `head` has, or it is gone, or its terminal is.
  const bool has_no_reader = error == EPIPE || error == EIO || error == ECONNRESET;
  if (rule_.tries_each && !has_no_reader) {
    is_cut_ = is_cut_ || written_ > 0;
    line_.clear();
    written_ = 0;
    ++dropped_;
    return;
  }
  is_gone_ = true;
  if (!has_no_reader) {
    failure_ = std::make_exception_ptr(FileError("standard output", "cannot be written: " + errno_text(error)));
  }
  waiting_.clear();
  line_.clear();
}

void LineOutput::Lines::make_room(std::unique_lock<std::mutex>& lock) {
  if (waiting_.size() >= rule_.most_waiting && !is_stuck_) {
    const std::uint64_t before = progress_;
    room_.wait_for(lock, rule_.patience, [&] { return progress_ != before || is_gone_; });
    is_stuck_ = progress_ == before;
  }
  while (!waiting_.empty() && waiting_.size() >= rule_.most_waiting) {
    waiting_.pop_front();
    ++dropped_;
  }
}

bool LineOutput::Lines::add(std::string line) {
  std::unique_lock lock(mutex_);
  make_room(lock);
  if (is_gone_) return false;
  const bool is_alone = !has_lines();
  waiting_.push_back(std::move(line));
  if (is_alone && !is_terminal_) {
    while (can_write() && is_writable({}) && write_some(lock)) {
    }
  }
  wake_.notify_one();
  return has_lines();
}

void LineOutput::Lines::wait_for_thread() {
  std::unique_lock lock(mutex_);
  const std::size_t lines = waiting_.size() + (line_.empty() ? 0 : 1);
  if (is_terminal_ && lines == 1) room_.wait_for(lock, kHandover, [this] { return !has_lines(); });
}

void LineOutput::Lines::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return is_ending_ || can_write(); });
    if (is_ending_) return;
    lock.unlock();
    const bool has_room = is_writable(kOutputSlice);
    lock.lock();
    if (has_room && can_write()) write_some(lock);
    room_.notify_one();
  }
}

void LineOutput::Lines::wait_for_reader() {
  constexpr std::chrono::milliseconds kLeastPatience{1000};
  std::unique_lock lock(mutex_);
  while (has_lines()) {
    const std::uint64_t before = progress_;
    room_.wait_for(lock, std::max(rule_.patience, kLeastPatience), [&] { return progress_ != before || !has_lines(); });
    if (progress_ == before) break;
  }
  dropped_ += waiting_.size() + (line_.empty() ? 0 : 1);
  waiting_.clear();
}

bool LineOutput::Lines::end() {
  std::unique_lock lock(mutex_);
  is_ending_ = true;
  wake_.notify_one();
  return room_.wait_for(lock, kOutputSlice, [this] { return !is_writing_; });
}

LineOutput::LineOutput(const Rule& rule, int descriptor) : lines_(std::make_shared<Lines>(rule, descriptor)) {}

LineOutput::~LineOutput() { end(); }

void LineOutput::write(std::string line) {
  if (line.empty() || !lines_->add(std::move(line))) return;
  start();
  lines_->wait_for_thread();
}

void LineOutput::start() {
  if (thread_.joinable()) return;
  const SignalsBlocked blocked;
  thread_ = std::thread([lines = lines_] { lines->work(); });
}

void LineOutput::finish() {
  lines_->wait_for_reader();
  end();
  if (const std::exception_ptr failure = lines_->failure()) std::rethrow_exception(failure);
}

bool LineOutput::has_failed() const { return lines_->failure() != nullptr; }

std::uint64_t LineOutput::dropped() const { return lines_->dropped(); }

void LineOutput::end() {
  if (!thread_.joinable()) return;
  lines_->end() ? thread_.join() : thread_.detach();
}

}  // namespace gdtslam
