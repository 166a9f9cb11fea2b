// Inputs of whole lines: a file that grows, and senders that connect to a socket, one after the other.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <thread>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "listening_socket.hpp"
#include "live_input.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "whole_lines.hpp"

namespace gdtslam {
namespace {

using InputClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookAgain{20};  // at a file that has not grown
constexpr std::chrono::seconds kPatienceWithSender{5};

class LineInput : public LiveInput {
 public:
  using LiveInput::LiveInput;

  std::size_t read(std::span<char> target) final {
    while (lines_.is_empty()) {
      if (is_over()) {
        leave();
        return 0;
      }
      look();
    }
    return lines_.take(target);
  }

 protected:
  /// Takes what is there, or waits a moment.
  virtual void look() = 0;
  /// The file or sender is gone: half a line is dropped.
  void leave() {
    if (lines_.drop_rest()) count_half_line();
  }
  /// Bytes that were read from it, as ::read() counts them.
  ssize_t take_from(int descriptor) {
    const ssize_t count = ::read(descriptor, block_.data(), block_.size());
    if (count > 0) lines_.add({block_.data(), static_cast<std::size_t>(count)});
    return count;
  }

 private:
  WholeLines lines_;
  std::array<char, std::size_t{1} << 16U> block_{};
};

class FollowedFile final : public LineInput {
 public:
  explicit FollowedFile(const std::string& path) : LineInput(path) {
    open();
    if (descriptor_ < 0) throw FileError(path, "cannot be opened: " + errno_text(errno));
    if (!S_ISREG(status_.st_mode)) {
      ::close(descriptor_);
      throw FileError(path, "cannot grow like a file; give a pipe without --follow");
    }
  }
  ~FollowedFile() override { ::close(descriptor_); }

 private:
  void open() {
    descriptor_ = ::open(name().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ >= 0) ::fstat(descriptor_, &status_);
    position_ = 0;
  }

  void look() override {
    const ssize_t count = take_from(descriptor_);
    if (count < 0 && errno != EINTR) throw FileError(name(), "cannot be read: " + errno_text(errno));
    if (count > 0) {
      position_ += count;
    } else if (has_begun_anew()) {
      print_remark(name() + " was replaced or cut: the new file is read from its beginning");
      leave();
      const int before = descriptor_;
      open();
      ::close(before);
      if (descriptor_ < 0) throw FileError(name(), "cannot be opened: " + errno_text(errno));
    } else {
      std::this_thread::sleep_for(kLookAgain);
    }
  }

  /// Log rotation: another file has the name, or this one was cut. While no file has the name one is waited for.
  [[nodiscard]] bool has_begun_anew() const {
    struct stat now {};
    if (::stat(name().c_str(), &now) != 0 || !S_ISREG(now.st_mode)) return false;
    return now.st_ino != status_.st_ino || now.st_dev != status_.st_dev || now.st_size < position_;
  }

  int descriptor_ = -1;
  off_t position_ = 0;
  struct stat status_ {};
};

class SenderInput final : public LineInput {
 public:
  explicit SenderInput(const std::string& address) : LineInput(address), socket_(address) {}
  ~SenderInput() override { hang_up(); }

 private:
  void look() override {
    if (sender_ < 0) {
      if (wait_for(socket_.descriptor())) sender_ = socket_.accept();
      heard_ = InputClock::now();
    } else if (wait_for(sender_)) {
      receive();
    } else if (InputClock::now() - heard_ > kPatienceWithSender && wait_for(socket_.descriptor(), 0)) {
      print_remark("a sender that was silent for 5 s makes way for the next one");
      hang_up();
    }
  }

  // However a connection ends, the sender is gone and may come back.
  void receive() {
    heard_ = InputClock::now();
    const ssize_t count = take_from(sender_);
    if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) hang_up();
  }

  void hang_up() {
    if (sender_ >= 0) ::close(sender_);
    sender_ = -1;
    leave();
  }

  ListeningSocket socket_;
  int sender_ = -1;
  InputClock::time_point heard_;
};

}  // namespace

std::unique_ptr<LiveInput> follow_file(const std::string& path) { return std::make_unique<FollowedFile>(path); }
std::unique_ptr<LiveInput> listen_at(const std::string& address) { return std::make_unique<SenderInput>(address); }

}  // namespace gdtslam
