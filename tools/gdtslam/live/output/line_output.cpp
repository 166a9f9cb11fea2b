#include "line_output.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
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

/// Waits for the reader without limit; returns 0 or the error.
int write_whole(int descriptor, const std::string& line) {
  for (std::size_t written = 0; written < line.size();) {
    const ssize_t count = ::write(descriptor, line.data() + written, line.size() - written);
    if (count >= 0) {
      written += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {  // set by another user of the pipe
      pollfd output{.fd = descriptor, .events = POLLOUT, .revents = 0};
      ::poll(&output, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

}  // namespace

/// State that the writer and the thread share.
class LineOutput::Lines {
 public:
  Lines(const Rule& rule, int descriptor) : rule_(rule), descriptor_(descriptor) {}

  void add(std::string line);
  /// Loop of the thread.
  void work();
  /// Drops the remaining lines of a hanging reader. Returns whether the thread ends now; else it waits in a system
  /// call.
  bool end(bool is_patient);
  [[nodiscard]] std::exception_ptr failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }
  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  [[nodiscard]] bool has_lines() const { return is_writing_ || !waiting_.empty(); }
  void stop(int error);

  Rule rule_;
  int descriptor_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> waiting_;
  std::uint64_t written_ = 0;  // number of lines
  std::uint64_t dropped_ = 0;
  bool is_writing_ = false;
  bool is_stuck_ = false;  // the reader, after patience ran out
  bool is_gone_ = false;
  bool is_ending_ = false;
  std::exception_ptr failure_;
};

void LineOutput::Lines::add(std::string line) {
  std::unique_lock lock(mutex_);
  if (waiting_.size() >= rule_.most_waiting && !is_stuck_) {
    const std::uint64_t before = written_;
    changed_.wait_for(lock, rule_.patience, [&] { return written_ != before || is_gone_; });
    is_stuck_ = written_ == before;
  }
  if (is_gone_) return;
  for (; !waiting_.empty() && waiting_.size() >= rule_.most_waiting; ++dropped_) waiting_.pop_front();
  waiting_.push_back(std::move(line));
  changed_.notify_all();
}

void LineOutput::Lines::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::string line = std::move(waiting_.front());
    waiting_.pop_front();
    is_writing_ = true;
    lock.unlock();
    const int error = write_whole(descriptor_, line);
    lock.lock();
    is_writing_ = is_stuck_ = false;
    ++written_;
    if (error != 0) stop(error);
    changed_.notify_all();
  }
}

// A closed pipe or a lost terminal means that the reader is gone; any other error is a failure.
void LineOutput::Lines::stop(int error) {
  is_gone_ = true;
  waiting_.clear();
  if (error == EPIPE || error == EIO || error == ECONNRESET) return;
  failure_ = std::make_exception_ptr(FileError("standard output", "cannot be written: " + errno_text(error)));
}

bool LineOutput::Lines::end(bool is_patient) {
  constexpr std::chrono::milliseconds kLeastPatience{1000};
  std::unique_lock lock(mutex_);
  for (std::uint64_t before = written_ + 1; is_patient && has_lines() && before != written_;) {
    before = written_;
    changed_.wait_for(lock, std::max(rule_.patience, kLeastPatience), [&] { return written_ != before; });
  }
  if (!is_ending_) dropped_ += waiting_.size() + (is_writing_ ? 1 : 0);
  waiting_.clear();
  is_ending_ = true;
  changed_.notify_all();
  return !is_writing_;
}

LineOutput::LineOutput(const Rule& rule, int descriptor) : lines_(std::make_shared<Lines>(rule, descriptor)) {
  const SignalsBlocked blocked;
  thread_ = std::thread([lines = lines_] { lines->work(); });
}

LineOutput::~LineOutput() {
  if (thread_.joinable()) lines_->end(false) ? thread_.join() : thread_.detach();
}

void LineOutput::write(std::string line) {
  if (!line.empty()) lines_->add(std::move(line));
}

void LineOutput::finish() {
  if (thread_.joinable()) lines_->end(true) ? thread_.join() : thread_.detach();
  if (const std::exception_ptr failure = lines_->failure()) std::rethrow_exception(failure);
}

bool LineOutput::has_failed() const { return lines_->failure() != nullptr; }

std::uint64_t LineOutput::dropped() const { return lines_->dropped(); }

}  // namespace gdtslam
