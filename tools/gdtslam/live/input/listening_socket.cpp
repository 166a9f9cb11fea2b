#include "listening_socket.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <memory>
#include <system_error>
#include <thread>

#include "engine/core/files/retried.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

constexpr int kMostWaiting = 4;  // senders, while another one is connected

// A host that was switched off never says that it is gone.
void ask_whether_alive(int connection) {
  const auto set = [connection](int level, int name, int value) {
    ::setsockopt(connection, level, name, &value, sizeof(value));
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 10);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 5);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

sockaddr_un name_of(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof(name.sun_path)) {
    throw UsageError(fmt::format("--listen: the path of a socket has less than {} bytes", sizeof(name.sun_path)));
  }
  std::memcpy(name.sun_path, path.c_str(), path.size() + 1);
  return name;
}

// Nobody has a socket that refuses a connection. Whatever else comes of one, it is somebody's: of another type, with no
// place for one more, or of a user who lets nobody in.
bool is_dead(const sockaddr_un& name) {
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const auto* const generic = reinterpret_cast<const sockaddr*>(&name);
  const bool is_refused =
      retried([&] { return ::connect(probe, generic, sizeof(name)); }) != 0 && errno == ECONNREFUSED;
  ::close(probe);
  return is_refused;
}

constexpr unsigned kMostListeningPort = 65535;

std::optional<unsigned> port_of(const std::string& text) {
  unsigned port = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, port);
  return read.ec == std::errc{} && read.ptr == end && port <= kMostListeningPort ? std::optional(port) : std::nullopt;
}

using AddressList = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

AddressList numeric_address(const std::string& host, const std::string& port) {
  addrinfo wanted{};
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found) != 0) found = nullptr;
  return {found, &::freeaddrinfo};
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

ListeningSocket::~ListeningSocket() { close(); }

// The name goes first: nobody replaces a socket that somebody has.
void ListeningSocket::close() {
  if (made_ && identity_of(path_) == made_) ::unlink(path_.c_str());
  made_.reset();
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

std::optional<ListeningSocket::Identity> ListeningSocket::identity_of(const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return std::nullopt;
  return Identity{status.st_dev, status.st_ino};
}

void ListeningSocket::fail(const std::string& what) {
  const std::string text = what + ": " + errno_text(errno);
  close();
  throw FileError(address_, text);
}

// Away with a socket that a process left that was killed.
void ListeningSocket::clear_name(const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return;
  if (!S_ISSOCK(status.st_mode)) {
    errno = EEXIST;
    fail("cannot be listened at, a file has this name");
  }
  if (!is_dead(name_of(path))) {
    errno = EADDRINUSE;
    fail("cannot be listened at, a process does so");
  }
  ::unlink(path.c_str());
}

void ListeningSocket::listen_at_path(const std::string& path) {
  const sockaddr_un name = name_of(path);
  clear_name(path);
  descriptor_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) fail("cannot be made");
  if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0) fail("cannot be listened at");
  path_ = path;
  made_ = identity_of(path);
  if (::listen(descriptor_, kMostWaiting) != 0) fail("cannot be listened at");
}

void ListeningSocket::listen_at_port(const std::string& host_and_port) {
  const std::size_t colon = host_and_port.rfind(':');
  std::string host = colon == std::string::npos ? "127.0.0.1" : host_and_port.substr(0, colon);
  const std::string port = colon == std::string::npos ? host_and_port : host_and_port.substr(colon + 1);
  if (host.size() > 2 && host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  const std::optional<unsigned> number = port_of(port);  // the C library takes more for one, and cuts it to 16 bits
  const AddressList found = numeric_address(host, port);
  if (!number || host.empty() || !found) {
    throw UsageError(
        fmt::format("--listen: '{}' has no port from 0 to 65535, or an address that is no number", address_));
  }
  descriptor_ = ::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) fail("cannot be made");
  const int yes = 1;
  ::setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (::bind(descriptor_, found->ai_addr, found->ai_addrlen) != 0) fail("cannot be listened at");
  if (::listen(descriptor_, kMostWaiting) != 0) fail("cannot be listened at");
  if (*number == 0) tell_port(host);
}

// Which one it became nobody else knows.
void ListeningSocket::tell_port(const std::string& host) const {
  sockaddr_storage bound{};
  socklen_t size = sizeof(bound);
  std::array<char, 8> port{};
  auto* const generic = reinterpret_cast<sockaddr*>(&bound);
  if (::getsockname(descriptor_, generic, &size) != 0) return;
  if (::getnameinfo(generic, size, nullptr, 0, port.data(), port.size(), NI_NUMERICSERV) != 0) return;
  print_remark(
      fmt::format("listens at tcp:{}:{}", host.find(':') == std::string::npos ? host : "[" + host + "]", port.data()));
}

// Where there is no descriptor left for it the connection stays in line, and would wake whoever waits for one at once.
int ListeningSocket::accept() const {
  constexpr std::chrono::milliseconds kUntilThereIsRoom{50};
  const int connection = ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
  if (connection < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM)) {
    std::this_thread::sleep_for(kUntilThereIsRoom);
  }
  if (connection >= 0 && path_.empty()) ask_whether_alive(connection);
  return connection;
}

}  // namespace gdtslam
