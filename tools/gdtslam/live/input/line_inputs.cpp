// Inputs of whole lines: a file that grows, and senders that connect to a socket, one after the other.
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "live_input.hpp"
#include "tools/gdtslam/live/network/address.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "whole_lines.hpp"

namespace gdtslam {
namespace {

using InputClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLookAgain{20};  // wait at a file that has not grown
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
  /// Reads available data, or waits a moment.
  virtual void look() = 0;
  /// Drops an unfinished line, because the file or sender is gone.
  void leave() {
    if (lines_.drop_rest()) count_half_line();
  }
  /// Reads from the descriptor; returns the result of ::read().
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

  /// Log rotation: another file has the name, or this one was cut. While the name is missing, waits for a new file.
  [[nodiscard]] bool has_begun_anew() const {
    struct stat now {};
    if (::stat(name().c_str(), &now) != 0 || !S_ISREG(now.st_mode)) return false;
    return now.st_ino != status_.st_ino || now.st_dev != status_.st_dev || now.st_size < position_;
  }

  int descriptor_ = -1;
  off_t position_ = 0;
  struct stat status_ {};
};

constexpr int kMostWaiting = 4;  // senders that wait while one is connected

[[noreturn]] void fail(const std::string& address, const std::string& what, int error) {
  throw FileError(address, what + ": " + errno_text(error));
}

/// Whether nobody listens at this socket: it refuses a connection. Any other answer means that it is in use: by another
/// type of socket, with a full queue, or by a user who denies access.
bool is_dead(const sockaddr_un& name) {
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const int status = ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof(name));
  const bool is_refused = status != 0 && errno == ECONNREFUSED;
  ::close(probe);
  return is_refused;
}

/// A listening socket: on loopback or in the file system unless another address is given.
class ListeningSocket {
 public:
  /// unix:PATH, tcp:PORT or tcp:ADDRESS:PORT with a numeric address, in brackets if it has colons. Replaces a socket
  /// that a killed process left. Throws UsageError, FileError.
  explicit ListeningSocket(const std::string& address);
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// Removes the name in the file system, unless another socket has it by then.
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// The next connection, or -1 if there is none left.
  [[nodiscard]] int accept() const;

 private:
  void listen_at_path(const std::string& path);
  void listen_at_port(const std::string& host_and_port);
  void bind_to(int family, const void* address, unsigned size);

  std::string address_;
  std::string path_;  // name in the file system once bound, and the identity of the file
  struct stat made_ {};
  int descriptor_ = -1;
};

ListeningSocket::ListeningSocket(const std::string& address) : address_(address) {
  constexpr std::string_view kUnix = "unix:";
  constexpr std::string_view kTcp = "tcp:";
  if (address.starts_with(kUnix) && address.size() > kUnix.size()) {
    listen_at_path(address.substr(kUnix.size()));
  } else if (address.starts_with(kTcp)) {
    listen_at_port(address.substr(kTcp.size()));
  } else {
    throw UsageError(fmt::format("--listen: '{}' is none of unix:PATH, tcp:PORT and tcp:ADDRESS:PORT", address));
  }
}

// The name is removed first, so that nobody replaces a socket that is in use.
ListeningSocket::~ListeningSocket() {
  struct stat now {};
  const bool is_there = !path_.empty() && ::lstat(path_.c_str(), &now) == 0;
  if (is_there && now.st_ino == made_.st_ino && now.st_dev == made_.st_dev) ::unlink(path_.c_str());
  ::close(descriptor_);
}

void ListeningSocket::bind_to(int family, const void* address, unsigned size) {
  descriptor_ = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) fail(address_, "cannot be made", errno);
  const int yes = 1;
  ::setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (::bind(descriptor_, static_cast<const sockaddr*>(address), size) == 0 && ::listen(descriptor_, kMostWaiting) == 0)
    return;
  const int error = errno;
  ::close(descriptor_);
  fail(address_, "cannot be listened at", error);
}

void ListeningSocket::listen_at_path(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof(name.sun_path)) {
    throw UsageError(fmt::format("--listen: the path of a socket has less than {} bytes", sizeof(name.sun_path)));
  }
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (!S_ISSOCK(status.st_mode)) fail(address_, "cannot be listened at, a file has this name", EEXIST);
    if (!is_dead(name)) fail(address_, "cannot be listened at, a process does so", EADDRINUSE);
    ::unlink(path.c_str());
  }
  bind_to(AF_UNIX, &name, sizeof(name));
  if (::lstat(path.c_str(), &made_) == 0) path_ = path;
}

void ListeningSocket::listen_at_port(const std::string& host_and_port) {
  std::optional<NetworkAddress> address = network_address(host_and_port);
  if (!address) {
    throw UsageError(
        fmt::format("--listen: '{}' has no port from 0 to 65535, or an address that is not a number", address_));
  }
  addrinfo wanted{};
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address->host.c_str(), std::to_string(address->port).c_str(), &wanted, &found) != 0) {
    fail(address_, "cannot be listened at", EADDRNOTAVAIL);
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, &::freeaddrinfo);
  bind_to(found->ai_family, found->ai_addr, found->ai_addrlen);
  if (address->port != 0) return;
  sockaddr_storage bound{};
  socklen_t size = sizeof(bound);
  ::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&bound), &size);
  address->port = ntohs(reinterpret_cast<const sockaddr_in*>(&bound)->sin_port);  // at the same place for IPv6
  print_remark("listens at tcp:" + address->text());
}

int ListeningSocket::accept() const { return ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC); }

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

  // Any end of a connection means that the sender is gone and may come back.
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
