#include "line_output.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kOutputSlice_ms = 100;  // after which the thread looks whether it is to end

bool is_writable(int wait_ms) {
  pollfd output{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  return ::poll(&output, 1, wait_ms) > 0;
}

}  // namespace

LineOutput::~LineOutput() { end(); }

// A pipe that can be written takes so many bytes without making anybody wait. True where the first line is out.
bool LineOutput::write_some() {
  const std::string& line = waiting_.front();
  const std::size_t count = std::min<std::size_t>(line.size() - written_, PIPE_BUF);
  const ssize_t done = ::write(STDOUT_FILENO, line.data() + written_, count);
  if (done < 0) {
    if (errno == EINTR || errno == EAGAIN) return false;
    is_gone_ = true;
    // The reader had enough, as `head` has, or it is gone, or its terminal is.
    if (errno != EPIPE && errno != EIO && errno != ECONNRESET) {
      failure_ = std::make_exception_ptr(FileError("standard output", "cannot be written: " + errno_text(errno)));
    }
    waiting_.clear();
    return false;
  }
  written_ += static_cast<std::size_t>(done);
  if (written_ < line.size()) return false;
  waiting_.pop_front();
  written_ = 0;
  note_progress();
  return true;
}

void LineOutput::note_progress() {
  ++progress_;
  is_stuck_ = false;
}

// One of which a part is out stays.
void LineOutput::drop_oldest() {
  const std::size_t oldest = written_ > 0 ? 1 : 0;
  if (waiting_.size() <= oldest) return;
  waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(oldest));
  ++dropped_;
}

void LineOutput::write(std::string line) {
  std::unique_lock lock(mutex_);
  if (is_gone_) return;
  if (waiting_.size() >= rule_.most_waiting && !is_stuck_) {
    const std::uint64_t before = progress_;
    room_.wait_for(lock, rule_.patience, [&] { return progress_ != before || is_gone_; });
    is_stuck_ = progress_ == before;
  }
  while (waiting_.size() >= rule_.most_waiting) drop_oldest();
  waiting_.push_back(std::move(line));
  if (waiting_.size() == 1) {
    while (!waiting_.empty() && is_writable(0) && write_some()) {
    }
  }
  if (waiting_.empty()) return;
  if (!thread_.joinable()) {
    const SignalsBlocked blocked;
    thread_ = std::thread([this] { work(); });
  }
  wake_.notify_one();
}

void LineOutput::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (is_ending_) return;
    lock.unlock();
    is_writable(kOutputSlice_ms);
    lock.lock();
    if (!waiting_.empty() && is_writable(0)) write_some();  // the writer may have been faster
    room_.notify_one();
  }
}

bool LineOutput::has_failed() {
  const std::lock_guard lock(mutex_);
  return failure_ != nullptr;
}

void LineOutput::finish() {
  constexpr std::chrono::milliseconds kLeastPatience{1000};
  {
    std::unique_lock lock(mutex_);
    while (!waiting_.empty()) {
      const std::uint64_t before = progress_;
      room_.wait_for(lock, std::max(rule_.patience, kLeastPatience),
                     [&] { return progress_ != before || waiting_.empty(); });
      if (progress_ == before) break;
    }
    dropped_ += waiting_.size();
    waiting_.clear();
  }
  end();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void LineOutput::end() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

}  // namespace gdtslam
