// Senders that connect to a socket, one after the other.
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "listening_socket.hpp"
#include "live_input.hpp"
#include "whole_lines.hpp"

namespace gdtslam {
namespace {

class SenderInput final : public LiveInput {
 public:
  explicit SenderInput(const std::string& address) : name_(address), socket_(address) {}
  ~SenderInput() override { leave(); }

  std::size_t read(std::span<char> target) override {
    while (lines_.is_empty()) {
      if (is_over()) {
        leave();
        return 0;
      }
      if (sender_ < 0) {
        if (wait_for(socket_.descriptor())) sender_ = socket_.accept();
      } else if (wait_for(sender_)) {
        receive();
      }
    }
    return lines_.take(target);
  }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  // However a connection ends, the sender is gone and may come back.
  void receive() {
    const ssize_t count = ::recv(sender_, block_.data(), block_.size(), 0);
    if (count > 0) return lines_.add({block_.data(), static_cast<std::size_t>(count)});
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return;
    leave();
  }

  void leave() {
    if (sender_ >= 0) ::close(sender_);
    sender_ = -1;
    if (lines_.drop_rest()) count_half_line();
  }

  std::string name_;
  ListeningSocket socket_;
  int sender_ = -1;
  WholeLines lines_;
  std::array<char, std::size_t{1} << 16U> block_{};
};

}  // namespace

std::unique_ptr<LiveInput> listen_at(const std::string& address) { return std::make_unique<SenderInput>(address); }

}  // namespace gdtslam
