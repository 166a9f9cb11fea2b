#include "listening_socket.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/live/network/address.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

constexpr int kMostWaiting = 4;  // senders, while another one is connected

[[noreturn]] void fail(const std::string& address, const std::string& what, int error) {
  throw FileError(address, what + ": " + errno_text(error));
}

/// A socket that refuses a connection belongs to nobody. After any other answer it is somebody's: of another type, with
/// no place for one more, or of a user who lets nobody in.
bool is_dead(const sockaddr_un& name) {
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const int status = ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof(name));
  const bool is_refused = status != 0 && errno == ECONNREFUSED;
  ::close(probe);
  return is_refused;
}

}  // namespace

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

// The name goes first: nobody replaces a socket that somebody has.
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
  address->port = ntohs(reinterpret_cast<const sockaddr_in*>(&bound)->sin_port);  // where IPv6 has it too
  print_remark("listens at tcp:" + address->text());
}

int ListeningSocket::accept() const { return ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC); }

}  // namespace gdtslam
