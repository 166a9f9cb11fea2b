// The page of `live`: which requests are answered, as texts and as bytes that come over a connection.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "target.hpp"
#include "tools/gdtslam/live/page/live_page.hpp"
#include "tools/gdtslam/live/page/server/page_address.hpp"

namespace gdtslam::fuzz {
namespace detail {

/// A connection to the page of this process, as a browser has one.
class PageConnection {
 public:
  explicit PageConnection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return;
    int error = errno;
    if (error == EINTR) error = error_once_connected();  // by the fuzzer's clock
    require(error == 0, std::strerror(error));
  }
  PageConnection(const PageConnection&) = delete;
  PageConnection& operator=(const PageConnection&) = delete;
  ~PageConnection() { ::close(socket_); }

  void send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return;  // the page has had enough
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  /// What comes until nothing does for some milliseconds; a page that hears no more ends the connection.
  [[nodiscard]] std::string answer() const {
    constexpr int kQuiet_ms = 3;
    constexpr int kEnd_ms = 5000;
    std::string text = received(kQuiet_ms);
    ::shutdown(socket_, SHUT_WR);
    return text + received(kEnd_ms);
  }

 private:
  /// A connection that a signal interrupted is made nevertheless.
  [[nodiscard]] int error_once_connected() const {
    pollfd wanted{socket_, POLLOUT, 0};
    while (::poll(&wanted, 1, -1) < 0) {
      if (errno != EINTR) return errno;
    }
    int error = 0;
    socklen_t size = sizeof(error);
    return ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
  }
  [[nodiscard]] std::string received(int quiet_ms) const {
    std::string text;
    std::array<char, 4096> piece;
    pollfd wanted{socket_, POLLIN, 0};
    while (::poll(&wanted, 1, quiet_ms) > 0) {
      const ssize_t count = ::recv(socket_, piece.data(), piece.size(), 0);
      if (count <= 0) break;
      text.append(piece.data(), static_cast<std::size_t>(count));
    }
    return text;
  }
  int socket_;
};

}  // namespace detail

/// Three lines: an address of --page, the host that a request names, the page that it comes from. Who asks from a page
/// of another site gets nothing; of this host alone only its own names are answered.
inline void read_page_address(std::span<const std::byte> data) {
  std::array<std::string, 3> lines;
  std::string_view rest = text_of(data);
  for (std::string& line : lines) {
    line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  expect_typed<UsageError>([&] {
    const PageAddress address = page_address_of(lines[0]);
    require(address.port >= 0 && address.port <= 65535);
    in6_addr bytes{};
    require(::inet_pton(AF_INET, address.host.c_str(), &bytes) == 1 ||
            ::inet_pton(AF_INET6, address.host.c_str(), &bytes) == 1);
    if (!may_ask(address, lines[1], lines[2])) return;
    require(lines[2].empty() || lines[2] == "http://" + lines[1], "a page of another site is answered");
    require(!address.is_loopback() || lines[1].starts_with("localhost") || lines[1].starts_with("[::1]") ||
                lines[1].starts_with(address.host),
            "another name of this host is answered");
  });
}

/// What a browser sends, or whoever wants to harm: an answer is one of HTTP, and the page itself goes only to a request
/// that names this host by one of its own names.
inline void read_page_requests(std::span<const std::byte> data) {
  static const std::unique_ptr<LivePage> page = open_page("0", "fuzz");
  static const std::string url = page->url();
  static const auto port = static_cast<std::uint16_t>(std::atoi(url.c_str() + url.rfind(':') + 1));
  std::string request(text_of(data));
  const std::size_t place = request.find("PORT");  // that of the input's page is another each time
  if (place != std::string::npos) request.replace(place, 4, std::to_string(port));
  const detail::PageConnection connection(port);
  connection.send(request);
  const std::string answer = connection.answer();
  require(answer.empty() || answer.starts_with("HTTP/1."), "an answer that is none of HTTP");
  if (!answer.starts_with("HTTP/1.1 200") && !answer.starts_with("HTTP/1.1 101")) return;
  const auto names = [&request](std::string_view name) { return request.find(name) != std::string::npos; };
  require(names("localhost") || names("127.0.0.1") || names("[::1]"), "the page goes to whoever asks");
}

inline constexpr std::array kPageTargets{FuzzTarget{"page_address", read_page_address, 3},
                                         FuzzTarget{"page_requests", read_page_requests, 3}};

}  // namespace gdtslam::fuzz
